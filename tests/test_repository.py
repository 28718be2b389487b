"""What holds of the repository itself: sizes, rooms, cases, notebooks, and that its texts tell the truth."""

from __future__ import annotations

import re
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

import jupytext
import nbformat
import pytest
from ruamel.yaml import YAML

from rfm.app.case import load_case

ROOT = Path(__file__).parents[1]
PACKAGES = ("rfm", "structures", "solvers")
MODULES = sorted(path for package in PACKAGES for path in (ROOT / package).rglob("*.py"))
CASES = sorted((ROOT / "cases").rglob("*.yaml"))
SCRIPTS = sorted((ROOT / "notebooks").glob("*.py"))


def name(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


def texts() -> list[Path]:
    """Every text of the repository, as git would see it."""
    suffixes = {
        ".py",
        ".md",
        ".toml",
        ".yaml",
        ".yml",
        ".lock",
        ".cff",
        ".j2",
        ".html",
        ".css",
        ".ipynb",
        ".txt",
    }
    roots = [*PACKAGES, "cases", "tests", "notebooks", "benchmarks", "docs", ".ci"]
    found = [path for root in roots for path in (ROOT / root).rglob("*") if path.suffix in suffixes]
    return [
        path
        for path in [*found, *ROOT.glob("*.*"), ROOT / "Makefile", ROOT / ".ci" / "run"]
        if path.is_file()
    ]


def test_no_two_test_files_have_one_name() -> None:
    names = [path.name for path in (ROOT / "tests").rglob("test_*.py")]
    assert sorted(names) == sorted(set(names))


@pytest.mark.parametrize("path", MODULES, ids=name)
def test_a_module_fits_on_a_few_screens(path: Path) -> None:
    assert len(path.read_text().splitlines()) <= 400


def test_the_rooms_import_one_way_only() -> None:
    run = subprocess.run(
        [sys.executable, "-c", "from importlinter.cli import lint_imports; raise SystemExit(lint_imports())"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stdout + run.stderr


def test_importing_rfm_loads_nothing_heavy() -> None:
    heavy = ["jax", "pyvista", "matplotlib", "scipy", "h5py", "pyamg", "pydantic", "jinja2", "meshio"]
    code = f"import sys, rfm; print([m for m in {heavy!r} if m in sys.modules])"
    run = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "[]"


@pytest.mark.parametrize("path", CASES, ids=name)
def test_a_case_says_how_it_is_known_to_be_right(path: Path) -> None:
    text = path.read_text()
    case: dict[str, Any] = YAML(typ="safe").load(text)
    assert text.startswith("#"), "a comment first: what it shows and where the reference is from"
    assert case["expect"], "a limit"
    references = [one for one in case["expect"].values() if isinstance(one, dict) and "value" in one]
    assert "exact" in case or references, "a closed form, or a reference value with its tolerance"


def normalised(requirement: str) -> str:
    """Name of a requirement as locks write it: lower case, hyphens only."""
    return re.sub(r"[-_.]+", "-", re.split(r"[<>=~! ]", requirement)[0]).lower()


def test_the_locks_hold_hashes_and_no_address() -> None:
    for lock in sorted(ROOT.glob("requirements*.lock")):
        text = lock.read_text()
        assert not re.search(r"://|--find-links|--index-url|file:|^/|\s/[a-z]", text, re.MULTILINE)
        requirements = re.findall(r"^[a-z0-9][\w.-]*==\S+", text, re.MULTILINE)
        assert len(requirements) == len(set(requirements)) > 50
        assert text.count("--hash=sha256:") >= len(requirements)


def test_the_locks_cover_what_the_project_asks_for() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    extras = project["optional-dependencies"]
    for lock, asked in (
        ("requirements.lock", [*project["dependencies"], *extras["dev"]]),
        ("requirements-bench.lock", [*project["dependencies"], *extras["bench"]]),
        ("requirements-peers.lock", [*project["dependencies"], *extras["peers"]]),
    ):
        locked = set(re.findall(r"^([a-z0-9][\w.-]*)==", (ROOT / lock).read_text(), re.MULTILINE))
        missing = [one for one in asked if normalised(one) not in locked]
        assert not missing, f"{lock} misses {missing}: run `make lock`"


def test_no_text_names_a_package_host_or_a_machine() -> None:
    hosts = re.compile(
        "|".join(["py" + r"pi\.org", "pythonhosted" + r"\.org", "anaconda" + r"\.org", r"/ho" + "me/"])
    )
    bad = [name(path) for path in texts() if hosts.search(path.read_text(errors="replace"))]
    assert not bad


def test_the_targets_the_texts_mention_exist() -> None:
    targets = set(re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(), re.MULTILINE))
    texts = (
        ROOT / "README.md",
        ROOT / "CONTRIBUTING.md",
        ROOT / ".ci" / "run",
        *(ROOT / "docs").glob("*.md"),
    )
    for path in texts:
        for words in re.findall(r"(?:^|`|^step )make ((?:[a-z-]+ ?)+)", path.read_text(), re.MULTILINE):
            unknown = set(words.split()) - targets
            assert not unknown, f"{name(path)} mentions make {unknown}"


def test_the_files_the_texts_mention_exist() -> None:
    for path in (ROOT / "README.md", ROOT / "CONTRIBUTING.md", *(ROOT / "docs").glob("*.md")):
        for link in re.findall(r"\]\(([^)#:]+?)(?:#[^)]*)?\)", path.read_text()):
            assert (path.parent / link).exists(), f"{name(path)} links to {link}"
        for case in re.findall(r"\bcases/[\w/]+\.yaml\b", path.read_text()):
            assert (ROOT / case).exists(), f"{name(path)} mentions {case}"


def test_the_cases_in_the_texts_are_right() -> None:
    blocks = [
        (path, block)
        for path in (ROOT / "README.md", *(ROOT / "docs").glob("*.md"))
        for block in re.findall(r"^```yaml\n(rfm: 1.*?)^```", path.read_text(), re.MULTILINE | re.DOTALL)
    ]
    assert blocks
    for path, block in blocks:
        case = YAML(typ="safe").load(block)
        assert load_case(case).title, name(path)


@pytest.mark.parametrize("script", SCRIPTS, ids=name)
def test_a_notebook_follows_its_script_and_holds_no_outputs(script: Path) -> None:
    written = nbformat.read(script.with_suffix(".ipynb"), as_version=4)
    paired = jupytext.read(script)
    assert [(c.cell_type, c.source) for c in written.cells] == [
        (c.cell_type, c.source) for c in paired.cells
    ], "run `make pair`"
    assert not any(cell.get("outputs") or cell.get("execution_count") for cell in written.cells)
