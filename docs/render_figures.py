"""Render the figures of the theory pages: every script of docs/figures writes its pictures (`make figures`).

A script has a function ``render(folder)`` that writes small PNG files.  Give names to render only these:
python docs/render_figures.py splines.
"""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

DOCS = Path(__file__).resolve().parent
SCRIPTS = DOCS / "figures"
PICTURES = DOCS / "pictures"
LARGEST = 150_000
"""Bytes a picture may have."""


def render(script: Path, folder: Path) -> None:
    """Let one script write its pictures into `folder`."""
    spec = importlib.util.spec_from_file_location(script.stem, script)
    if spec is None or spec.loader is None:
        raise SystemExit(f"{script} cannot be imported")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    module.render(folder)


def main() -> None:
    """Render what was asked for, or everything."""
    wanted = set(sys.argv[1:])
    PICTURES.mkdir(exist_ok=True)
    for script in sorted(SCRIPTS.glob("*.py")):
        if not wanted or script.stem in wanted:
            print(script.relative_to(DOCS.parent), flush=True)
            render(script, PICTURES)
    for picture in PICTURES.glob("*.png"):
        if picture.stat().st_size > LARGEST:
            raise SystemExit(f"{picture.name} has {picture.stat().st_size} bytes, more than {LARGEST}")


if __name__ == "__main__":
    main()
