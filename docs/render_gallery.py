"""Render docs/gallery: run every case, keep its picture small, write the page (`make gallery`).

Give names of cases to render only these: python docs/render_gallery.py annulus torus.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

from PIL import Image
from ruamel.yaml import YAML

import rfm

ROOT = Path(__file__).resolve().parents[1]
GALLERY = ROOT / "docs" / "gallery"
WIDTH = 720
COLOURS = 160
LARGEST = 150_000
"""Bytes a picture may have."""

HEADINGS = {
    "poisson": "Poisson's equation in the plane",
    "mixed": "Several kinds of conditions",
    "corners": "Corners",
    "three_d": "Space",
}


def folders() -> list[str]:
    """Folders of cases in the order of the page: those with a heading, then the others."""
    found = sorted(path.name for path in (ROOT / "cases").iterdir() if any(path.glob("*.yaml")))
    return [*(name for name in HEADINGS if name in found), *(name for name in found if name not in HEADINGS)]


def cases() -> list[Path]:
    """Cases in the order of the page."""
    return [path for folder in folders() for path in sorted((ROOT / "cases" / folder).glob("*.yaml"))]


def render(case: Path) -> None:
    """Run `case` and put its picture, reduced in size and colours, into the gallery."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / case.stem
        rfm.solve(case).save(out)
        with Image.open(out / "picture.png") as picture:
            image = picture.convert("RGB")
    image.thumbnail((WIDTH, WIDTH), Image.Resampling.LANCZOS)
    target = GALLERY / f"{case.stem}.png"
    image.quantize(COLOURS, dither=Image.Dither.NONE).save(target, optimize=True)
    if target.stat().st_size > LARGEST:
        raise SystemExit(f"{target.name} has {target.stat().st_size} bytes, more than {LARGEST}")


def page() -> str:
    """The page that shows every picture with its case."""
    lines = ["# Gallery", "", "Rendered by the program from the case files: `make gallery`.", ""]
    for folder in folders():
        lines += [f"## {HEADINGS.get(folder, folder.replace('_', ' ').capitalize())}", ""]
        for case in (path for path in cases() if path.parent.name == folder):
            title = YAML(typ="safe").load(case.read_text())["title"]
            source = case.relative_to(ROOT).as_posix()
            lines += [f"**{title}** ([{source}](../../{source}))", "", f"![{title}]({case.stem}.png)", ""]
    return "\n".join(lines).rstrip() + "\n"


def main() -> None:
    """Render what was asked for, or everything; write the page."""
    wanted = set(sys.argv[1:])
    GALLERY.mkdir(exist_ok=True)
    for case in cases():
        if not wanted or case.stem in wanted:
            print(case.relative_to(ROOT), flush=True)
            render(case)
    (GALLERY / "README.md").write_text(page())


if __name__ == "__main__":
    main()
