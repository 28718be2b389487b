"""Bad input: the exit code, the line and column, the words, and that nothing is written."""

import errno
import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from rfm.app.cli.application import app

CASE = """\
rfm: 1
title: Annulus
parameters: {R: 0.4, r: 0.1}
geometry:
  shapes:
    outer: {disk: {center: [0.5, 0.5], radius: R}}
    inner: {disk: {center: [0.5, 0.5], radius: r}}
  domain: outer - inner
equation: {poisson: {source: 1}}
boundary_conditions:
  - {on: all, dirichlet: 0}
discretization: {degree: 2, grid: 12}
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def invoke(*arguments: str):
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


def changed(*replacements: tuple[str, str]) -> str:
    text = CASE
    for old, new in replacements:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    return text


def written(folder: Path) -> set[str]:
    return {str(path.relative_to(folder)) for path in folder.rglob("*")}


BOX = """\
rfm: 1
geometry:
  shapes: {box: {rectangle: {min: [0, 0], max: [1, 1]}}}
  domain: box
equation: {poisson: {source: 1}}
boundary_conditions:
  - {on: box.left, periodic: {with: box.right}}
  - {on: rest, dirichlet: 0}
discretization: {degree: 2, grid: 12}
"""


def refuse(folder: Path, text: str, place: str, *words: str, command: str = "run", code: int = 2) -> str:
    (folder / "case.yaml").write_text(text)
    result = invoke(command, "case.yaml")
    assert result.exit_code == code, result.output
    assert result.stderr.startswith(f"case.yaml:{place}: "), result.stderr
    for word in words:
        assert word in result.stderr
    assert written(folder) == {"case.yaml"}
    assert "Traceback" not in result.output
    return result.stderr


OUTER = "    outer: {disk: {center: [0.5, 0.5], radius: R}}\n"
CONDITION = "  - {on: all, dirichlet: 0}\n"

BALL = OUTER + "    third: {ball: {center: [0, 0], radius: 1}}\n"
TWO_KINDS = "    outer: {disk: {center: [0, 0], radius: 1}, rectangle: {min: [0, 0], max: [1, 1]}}\n"
REST = "  - {on: rest, dirichlet: 0}\n"
UPPER_PIECES = (
    "  - {on: all, where: x > 0.5, dirichlet: 1}\n  - {on: outer, where: x > 0.6, dirichlet: 2}\n" + REST
)

SCHEMA = [
    # wrong keys
    ("title:", "titel:", "2:1", "unknown key 'titel'; did you mean 'title'?"),
    ("radius: R", "radus: R", "6:40", "geometry.shapes.outer.disk.radus: unknown key 'radus'; did you mean 'radius'?"),
    ("outer: {disk:", "outer: {dsik:", "6:13", "did you mean 'disk'?"),
    (OUTER, "    outer: {qqq: {}}\n", "6:13", "valid keys: half_plane, disk"),
    (", radius: R", "", "6:13", "geometry.shapes.outer.disk: the key 'radius' is missing"),
    ("rfm: 1\n", "rfm: 2\n", "1:6", "schema version 1, got 2"),
    ("rfm: 1\n", "", "1:1", "the key 'rfm' is missing"),
    ("discretization: {", "discretization: {singular: all, ", "12:28", "discretization.singular: unknown name 'all'"),
    ("degree: 2", "degree: 2, singular: corners", "12:39", "singular: must be auto or none here: the domain has"),
    ("degree: 2", "degree: 2, solver: {}", "12:29", "unknown key 'solver'"),
    # wrong types and values
    ("radius: R", "radius: -1", "6:48", "geometry.shapes.outer.disk.radius: must be positive, got -1"),
    ("radius: R", "radius: 0 - R", "6:48", "must be positive, got -0.4"),
    ("radius: R", "radius: [1]", "6:48", "must be a number or an expression of parameters, got a list"),
    ("radius: R", "radius: true", "6:48", "got true"),
    ("radius: R", "radius: x", "6:48", "unknown name 'x'"),
    ("radius: R", "radius: .nan", "6:48", "must be finite"),
    ("[0.5, 0.5], radius: R", "[0.5], radius: R", "6:28", "must have 2 coordinates, got 1"),
    ("[0.5, 0.5], radius: R", "[0.5, a], radius: R", "6:34", "unknown name 'a'"),
    ("[0.5, 0.5], radius: R", "here, radius: R", "6:28", "must be a list of 2 numbers, got 'here'"),
    ("degree: 2", "degree: 9", "12:26", "must be from 1 to 8, got 9"),
    ("degree: 2", "degree: 2.5", "12:26", "must be a whole number from 1 to 8, got 2.5"),
    ("grid: 12", "grid: many", "12:35", "must be a whole number"),
    ("grid: 12", "grid: 12, spacing: 0.1", "12:39", "grid and spacing exclude each other"),
    ("grid: 12", "basis: web", "12:36", "did you mean 'web-spline'?"),
    ("grid: 12", "weight: r9x", "12:37", "unknown name 'r9x'"),
    ("grid: 12", "weight: rp3", "12:37", "R_p needs an even p >= 2, got 3"),
    ("grid: 12", "weight: ralpha-1", "12:37", "R_alpha needs -1 < alpha < 1, got -1.0"),
    ("grid: 12", "weight: spline4", "12:37", "bidegree 1, 2 or 3, got 4"),
    ("grid: 12", "weight: 'spline2:group9'", "12:37", "groups 1 to 6, got 9"),
    ("discretization: {degree: 2, grid: 12}", "discretization: 3", "12:17", "must be a mapping with the keys basis"),
    (CONDITION, "  - 3\n", "11:5", "must be a mapping with the keys on, where"),
    ("boundary_conditions:\n" + CONDITION, "boundary_conditions: none\n", "10:22", "must be a list"),
    # shapes
    (OUTER, "    outer: {rectangle: {min: [0, 0], max: [1, 0]}}\n", "6:43", "must exceed min in y"),
    (OUTER, OUTER + "    third: {ball: {center: [0, 0, 0], radius: 1}}\n", "7:28", "must have 2 coordinates, got 3"),
    (OUTER, BALL, "7:13", "ball is three-dimensional, the other shapes are two-dimensional"),
    (OUTER, TWO_KINDS, "6:48", "has disk and rectangle"),
    (OUTER, "    outer: {move: [1, 0]}\n", "6:12", "needs a kind of shape"),
    (OUTER, "    outer: {disk: null}\n", "6:13", "needs a value for disk"),
    (OUTER, "    all: {disk: {center: [0.5, 0.5], radius: R}}\n", "6:5", "'all' is reserved"),
    (OUTER, OUTER + "    third: {disk: {center: [0, 0], radius: 1}}\n", "7:5", "not used by the domain"),
    ("outer - inner", "outer - iner", "8:19", "unknown shape 'iner'; did you mean 'inner'?"),
    ("outer - inner", "outer + inner", "8:17", "character '+'"),
    ("outer - inner", "outer - (inner", "8:19", "never closed"),
    ("outer - inner", "[outer, inner]", "8:11", "must be an expression of shapes"),
    # expressions
    ("source: 1", "source: sin(x", "9:33", "never closed"),
    ("source: 1", "source: 2^x^2 + foo", "9:38", "unknown name 'foo'"),
    ("source: 1", "source: x + z", "9:34", "'z' is no coordinate of this two-dimensional case (only x, y)"),
    ("source: 1", "source: t", "9:30", "no time t"),
    ("source: 1", 'source: "__import__(x)"', "9:31", "unknown function '__import__'"),
    ("source: 1", "source: 9**9**9", "9:33", "exponent"),
    ("source: 1", "source: 1/(R - 4*r)", "9:31", "division by zero"),
    ("source: 1", "source: x > 0", "9:30", "not a condition"),
    ("source: 1", "source: from exact", "9:30", "needs the key exact"),
    ("{R: 0.4, r: 0.1}", "{R: 0.4, r: R/S}", "3:27", "parameters.r: unknown name 'S'"),
    ("{R: 0.4, r: 0.1}", "{R: 0.4, r: 0.1, x: 1}", "3:30", "'x' is reserved"),
    ("{R: 0.4, r: 0.1}", "{R: r, r: 0.1}", "3:17", "unknown name 'r'"),
    # equations that are not there
    ("poisson: {source: 1}", "heat: {source: 1}", "9:12", "the equations are: poisson"),
    ("source: 1", "source: 1, advection: [1, 0]", "9:12", "there is no energy; choose method: galerkin"),
    ("source: 1", "source: 1, advection: 1", "9:44", "must be a list with one entry for each coordinate"),
    ("grid: 12}\n", "grid: 12}\nsolver: {method: least-square}\n", "13:18", "did you mean 'least-squares'?"),
    ("grid: 12}\n", "grid: 12}\nsolver: {linear: gmres}\n", "13:18", "does not suit the method ritz"),
    ("grid: 12}\n", "grid: 12}\nsolver: {device: cuda}\n", "13:18", "gpu"),
    (
        "grid: 12}\n",
        "grid: 12}\nsolver: {device: cpu, linear: superlu}\n",
        "13:18",
        "solver.device: cpu has no matrix that linear: superlu could take: choose linear: cg (or auto), or",
    ),
    ("grid: 12}\n", "grid: 12}\nsolver: {shards: 0}\n", "13:18", "must be all or a positive whole number, got 0"),
    ("grid: 12}\n", "grid: 12}\nsolver: {shards: most}\n", "13:18", "got 'most'"),
    ("grid: 12}\n", "grid: 12}\nsolver: {shards: 2}\n", "13:18", "choose device: gpu or cpu, or remove shards"),
    (
        "grid: 12}\n",
        "grid: 12}\nsolver: {device: cpu, shards: 99}\n",
        "13:31",
        "set XLA_FLAGS=--xla_force_host_platform_device_count=99 before the start",
    ),
    ("grid: 12}\n", "grid: 12}\nsolver: {weights: [1]}\n", "13:10", "those that have: least-squares"),
    ("grid: 12}\n", "grid: 12}\nsolver: {method: least-squares, weights: [1, 2]}\n", "13:42", "1 entries"),
    ("grid: 12}\n", "grid: 12}\nsolver: {method: least-squares, weights: [0]}\n", "13:43", "positive"),
    ("grid: 12}\n", "grid: 12}\nsolver: {conditions: strong}\n", "13:22", "natural"),
    # conditions
    ("dirichlet: 0", "dirichlet: 0, neumann: 1", "11:29", "has dirichlet and neumann"),
    (", dirichlet: 0", "", "11:5", "needs a condition, one of: dirichlet, neumann, robin"),
    ("dirichlet: 0", "dirichlet: null", "11:15", "needs a value for dirichlet"),
    ("dirichlet: 0", "traction: [0, 0]", "11:15", "the equation poisson has no condition traction"),
    ("dirichlet: 0", "oblique: {direction: [1, 0], value: 1}", "11:15", "no energy; choose method: galerkin"),
    ("dirichlet: 0", "oblique: {direction: [0, 0], value: 1}", "11:36", "must not be zero: give the direction"),
    ("dirichlet: 0", "oblique: {direction: [1], value: 1}", "11:36", "must have 2 components, got 1"),
    ("dirichlet: 0", "oblique: {direction: 1, value: 1}", "11:36", "must be a list with one entry for each"),
    ("dirichlet: 0", "oblique: {value: 1}", "11:15", "the key 'direction' is missing"),
    (
        "dirichlet: 0}",
        "oblique: {direction: [1, 0], value: 1}}\nsolver: {method: galerkin}",
        "10:1",
        "all is tangential near (0.50",
    ),
    ("dirichlet: 0", "robin: {coefficient: 1}", "11:15", "the key 'value' is missing"),
    ("on: all", "on: all, where: x + 1", "11:22", "a condition such as"),
    ("on: all", "on: []", "11:10", "name of a part or a list of names"),
    # results
    ("grid: 12}\n", "grid: 12}\nexpect: {relative_l2_eror: 1}\n", "13:10", "did you mean 'relative_l2_error'?"),
    ("grid: 12}\n", "grid: 12}\nexpect: {relative_l2_error: 1}\n", "13:10", "where the key exact is given"),
    ("grid: 12}\n", "grid: 12}\nexpect: {dofs: {value: 1}}\n", "13:16", "value and tolerance go together"),
    ("grid: 12}\n", "grid: 12}\nexpect: {integrals.q: 1}\n", "13:10", "unknown result"),
    ("grid: 12}\n", "grid: 12}\nstudy: {grid: [8, 4]}\n", "13:15", "must increase"),
    ("grid: 12}\n", "grid: 12}\nstudy: {}\n", "13:8", "needs a list of grids"),
    ("grid: 12}\n", "grid: 12}\nprobes: {A: [0.5]}\n", "13:13", "must have 2 coordinates"),
    ("grid: 12}\n", "grid: 12}\nintegrals: {q: {on: domain, of: flux}}\n", "13:33", "through a part of the boundary"),
    ("grid: 12}\n", "grid: 12}\nintegrals: {q: {on: domain, of: v^2}}\n", "13:33", "unknown name 'v'"),
]  # fmt: skip


@pytest.mark.parametrize(("old", "new", "place", "words"), SCHEMA)
def test_mistakes_in_the_text(folder, old, new, place, words):
    text = changed((old, new))
    if place:
        message = refuse(folder, text, place, words)
        assert message.rstrip("\n").endswith("^")
    else:
        (folder / "case.yaml").write_text(text)
        result = invoke("run", "case.yaml")
        assert result.exit_code == 2
        assert words in result.stderr


POLYGON = "    outer: {polygon: {vertices: [[0, 0], [1, 1], [1, 0], [0, 1]]}}\n"

MEANING = [
    (("outer - inner", "inner - outer"), "8:11", "empty"),
    ((OUTER, POLYGON), "6:33", "edge"),
    (("inner: {disk: {center: [0.5, 0.5]", "inner: {half_plane: {point: [0.5, 0.5], normal: [0, 0]"), "", "normal"),
    (("on: all", "on: outr"), "11:10", "no part 'outr'", "outer", "inner"),
    (("on: all", "on: outer"), "10:1", "no condition on inner", "on: rest"),
    ((CONDITION, CONDITION + "  - {on: inner, dirichlet: 1}\n"), "12:10", "conditions 0 and 1 overlap on inner"),
    ((CONDITION, CONDITION + "  - {on: rest, dirichlet: 1}\n"), "12:10", "nothing is left for 'rest'"),
    ((CONDITION, "  - {on: rest, dirichlet: 1}\n  - {on: rest, dirichlet: 2}\n"), "12:10", "already taken"),
    ((CONDITION, "  - {on: all, where: x > 0.5, dirichlet: 1}\n"), "10:1", "no condition on", "at ("),
    ((CONDITION, UPPER_PIECES), "12:5", "overlap on outer at ("),
    ((CONDITION, "  - {on: outer, where: x > 7, dirichlet: 1}\n" + REST), "11:24", "holds nowhere on outer"),
    (("grid: 12", "box: [[3, 3], [4, 4]], grid: 12"), "12:34", "does not touch the domain"),
    (("grid: 12", "box: [[0, 0], [0.5, 1]], grid: 12"), "12:34", "cuts the domain"),
    (("grid: 12", "grid: 3"), "12:35", "too coarse", "use grid: "),
    (("grid: 12", "grid: 80000"), "12:35", "of memory", "--allow-large"),
    (("grid: 12}\n", "grid: 12}\nprobes: {A: [0.5, 0.5]}\n"), "13:13", "outside the domain"),
    (("grid: 12}\n", "grid: 12}\nintegrals: {q: {on: outr, of: flux}}\n"), "13:21", "no part 'outr'"),
    (("source: 1", "source: 1/(x - x)"), "9:30", "the source is", "at x ="),
    (("source: 1", "source: log(0.2 - x)"), "9:30", "the source is nan at x ="),
    (("dirichlet: 0", "dirichlet: sqrt(y - 0.5)"), "11:26", "nan at x ="),
    (("source: 1", "source: 1, conductivity: log(x - 0.5)"), "9:47", "the conductivity is"),
]  # fmt: skip


@pytest.mark.parametrize(("replacement", "place", "words"), [(row[0], row[1], row[2:]) for row in MEANING])
def test_mistakes_in_the_meaning(folder, replacement, place, words):
    text = changed(replacement)
    if place:
        refuse(folder, text, place, *words)
    else:
        (folder / "case.yaml").write_text(text)
        assert invoke("run", "case.yaml").exit_code == 2


def test_self_intersecting_polygon_names_the_edges(folder):
    shape = "    outer: {polygon: {vertices: [[0, 0], [2, 2], [2, 0], [0, 2]]}}\n"
    message = refuse(
        folder, changed((OUTER, shape)), "6:33", "geometry.shapes.outer.polygon.vertices", command="check"
    )
    assert "edge" in message


def test_unbounded_domain(folder):
    shape = "    outer: {half_plane: {point: [0, 0], normal: [1, 0]}}\n"
    refuse(folder, changed((OUTER, shape)), "8:11", "unbounded; intersect it", command="check")


def test_several_mistakes_are_reported_at_once(folder):
    text = changed(("radius: R", "radius: -1"), ("degree: 2", "degre: 2"), ("source: 1", "source: foo"))
    message = refuse(folder, text, "6:48")
    assert [line.split(": ")[0] for line in message.splitlines() if line.startswith("case.yaml")] == [
        "case.yaml:6:48",
        "case.yaml:9:30",
        "case.yaml:12:18",
    ]


@pytest.mark.parametrize(
    ("text", "place", "words"),
    [
        ("", "1:1", "found nothing"),
        ("just words\n", "1:1", "a case file is a mapping"),
        ("a: [1\n", "2:1", "not valid YAML"),
        (CASE + "title: again\n", "13:1", "given twice"),
        ("a: &a [*a]\n", "1:8", "contains it"),
        ("[" * 200, "1:41", "nested deeper"),
        ("a: !!python/object:os.system x\n", "1:4", "tags are not allowed"),
    ],
)
def test_files_that_are_no_case(folder, text, place, words):
    refuse(folder, text, place, words)


def test_terminal_controls_are_not_printed(folder):
    (folder / "case.yaml").write_text(CASE.replace("title: Annulus", '"\\e[31mtitle": 1'))
    result = invoke("run", "case.yaml")
    assert result.exit_code == 2
    assert "unknown key" in result.stderr
    assert "\x1b" not in result.stderr


def test_yaml_bomb(folder):
    lines = ["a0: &a0 [x, x, x, x, x, x, x, x, x]"]
    lines += [f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 9)}]" for i in range(1, 12)]
    refuse(folder, "\n".join(lines), "1:13", "once aliases are expanded")


@pytest.mark.parametrize("command", ["run", "check", "study", "show"])
def test_missing_file(folder, command):
    (folder / "annulus.yaml").write_text(CASE)
    result = invoke(command, "anulus.yaml")
    assert result.exit_code == 2
    assert result.stderr == "anulus.yaml: there is no such file; did you mean annulus.yaml?\n"


@pytest.mark.parametrize(
    ("setting", "words"),
    [
        (
            "discretization.gird=3",
            "--set discretization.gird=3: discretization.gird: unknown key 'gird'; did you mean 'grid'?",
        ),
        ("discretisation.grid=3", "unknown key 'discretisation'; did you mean 'discretization'?"),
        ("discretization.grid", "expected key=value"),
        ("discretization.grid=[1", "not valid YAML"),
        ("boundary_conditions.4.on=inner", "'4' is no index of the 1 entries"),
        ("title.x=3", "is a value, it has no keys"),
        ("equation.poisson.source=x + foo", "unknown name 'foo'"),
        ("parameters.R=0.4/0", "division by zero"),
        ("parameters.R=0 - 1", "must be positive, got -1"),
    ],
)
def test_overrides(folder, setting, words):
    (folder / "case.yaml").write_text(CASE)
    result = invoke("run", "case.yaml", "--set", setting)
    assert result.exit_code == 2
    assert words in result.stderr
    assert written(folder) == {"case.yaml"}


def test_error_as_json(folder):
    (folder / "case.yaml").write_text(changed(("radius: R", "radius: -1"), ("source: 1", "source: foo")))
    result = invoke("run", "case.yaml", "--json")
    assert result.exit_code == 2
    found = json.loads(result.stdout)
    assert (found["status"], found["exit_code"]) == ("error", 2)
    assert [(row["place"], row["path"]) for row in found["errors"]] == [
        ("case.yaml:6:48", "geometry.shapes.outer.disk.radius"),
        ("case.yaml:9:30", "equation.poisson.source"),
    ]
    assert "must be positive" in result.stderr


def test_output_that_cannot_be_written(folder):
    (folder / "case.yaml").write_text(CASE)
    (folder / "file").write_text("mine")
    for out in ("file", "file/below"):
        result = invoke("run", "case.yaml", "--out", out)
        assert result.exit_code == 2
        assert "--out" in result.stderr
        assert written(folder) == {"case.yaml", "file"}
    assert (folder / "file").read_text() == "mine"


def test_foreign_directory_is_not_replaced(folder):
    (folder / "case.yaml").write_text(CASE)
    (folder / "docs").mkdir()
    (folder / "docs" / "thesis.tex").write_text("mine")
    assert invoke("run", "case.yaml", "--out", "docs").exit_code == 2
    assert written(folder) == {"case.yaml", "docs", "docs/thesis.tex"}


def test_disk_full(folder, monkeypatch):
    from rfm.app import output

    (folder / "case.yaml").write_text(CASE)
    assert invoke("run", "case.yaml", "--out", "run").exit_code == 0
    before = (folder / "run" / "summary.json").read_bytes()

    def full(path, content):
        path.write_bytes(content[: len(content) // 2])
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(output, "write_bytes", full)
    result = invoke("run", "case.yaml", "--out", "run", "--set", "discretization.grid=16")
    assert result.exit_code in (2, 3)
    assert "no space left" in result.stderr.lower()
    assert (folder / "run" / "summary.json").read_bytes() == before
    assert {path.name for path in folder.iterdir()} == {"case.yaml", "run"}


def test_incompatible_fluxes(folder):
    (folder / "case.yaml").write_text(changed(("dirichlet: 0", "neumann: 1")))
    result = invoke("run", "case.yaml")
    assert result.exit_code == 3
    assert written(folder) == {"case.yaml"}


def test_contradictory_corner_is_a_warning(folder):
    rectangle = "    outer: {rectangle: {min: [0, 0], max: [1, 1]}}\n"
    conditions = "  - {on: outer.left, dirichlet: 1}\n  - {on: rest, dirichlet: 0}\n"
    (folder / "case.yaml").write_text(changed((OUTER, rectangle), (CONDITION, conditions)))
    result = invoke("run", "case.yaml", "--out", "run")
    assert result.exit_code == 0, result.stderr
    assert "warning: " in result.output
    assert "differ by 1" in result.output


@pytest.mark.parametrize(
    ("old", "new", "place", "words"),
    [
        (
            "with: box.right",
            "with: box.rigth",
            "7:37",
            "has no part 'box.rigth', did you mean",
        ),
        ("with: box.right", "with: box.left", "7:37", "box.left cannot be its own partner"),
        ("with: box.right", "with: box.top", "7:20", "box.left and box.top do not face each other"),
        ("with: box.right", "factor: 1", "7:20", "the key 'with' is missing"),
        (
            "with: box.right",
            "with: box.right, factor: 2",
            "7:56",
            "must be 1, or -1 of an antiperiodic field",
        ),
        (
            "with: box.right",
            "with: box.right, shift: [1, 1]",
            "7:55",
            "must be (1, 0), the way from box.left to",
        ),
        ("{on: box.left, p", "{on: box.left, where: y > 0.5, p", "7:20", "has no where"),
        ("on: box.left", "on: all", "7:10", "joins two parts: name the one here, the other in 'with'"),
        ("grid: 12}", "grid: 12, basis: legendre}", "9:46", "use basis: web-spline"),
        ("grid: 12}", "spacing: 0.3}", "9:38", "must divide the period 1 along x, got 0.3"),
        (
            "grid: 12}",
            "grid: 12, box: [[-1, 0], [1, 1]]}",
            "9:44",
            "must end at the periodic parts, x = 0 and 1",
        ),
        ("on: rest, dirichlet: 0", "on: rest, dirichlet: x", "6:1", "are not periodic along x"),
        ("on: rest, dirichlet: 0}", "on: box.top, dirichlet: 0}", "6:1", "no condition on box.bottom"),
    ],
)
def test_periodic_conditions_that_cannot_be(folder, old, new, place, words):
    assert BOX.count(old) == 1
    refuse(folder, BOX.replace(old, new), place, words)


MATERIALS = """\
rfm: 1
geometry:
  shapes:
    box: {rectangle: {min: [0, 0], max: [1, 1]}}
    a: {disk: {center: [0.3, 0.5], radius: 0.2}}
    b: {disk: {center: [0.7, 0.5], radius: 0.15}}
  domain: box
equation:
  poisson:
    source: 1
    inclusions:
      - {region: a, conductivity: 5}
      - {region: b, conductivity: 2}
boundary_conditions:
  - {on: all, dirichlet: 0}
discretization: {degree: 2, grid: 12}
"""


@pytest.mark.parametrize(
    ("old", "new", "place", "words"),
    [
        ("region: a", "region: a | c", "12:22", "unknown shape 'c'; shapes: box, a, b"),
        ("region: a, ", "", "5:5", "the key 'region' is missing"),
        ("region: a,", "region: a &,", "12:21", "inclusions.0.region"),
        (
            "conductivity: 5",
            "conductivity: -5",
            "12:35",
            "inclusions.0.conductivity: must be positive, got -5",
        ),
        ("conductivity: 5", "conductivity: 0", "12:35", "must be positive, got 0"),
        ("conductivity: 5", "jump: from exact", "12:27", "'from exact' needs the key exact"),
        ("conductivity: 5", "jumps: 1", "12:21", "unknown key 'jumps'; did you mean 'jump'?"),
        ("radius: 0.15", "radius: 0.25", "13:18", "meets the inclusion a at ("),
        ("center: [0.7, 0.5]", "center: [5, 5]", "13:18", "the inclusion b has no interface with the matrix"),
        ("region: b,", "name: a, region: b,", "13:9", "the name 'a' is taken; give another"),
        ("grid: 12}", "grid: 12}\nexact: {matrix: 0, a: 0}", "17:1", "the exact solution in 'b' is missing"),
        (
            "grid: 12}",
            "grid: 12}\nexact: {matrix: 0, a: 0, c: 0}",
            "17:26",
            "unknown material 'c'; materials: matrix, a, b",
        ),
        ("grid: 12}", "grid: 12}\nsolver: {conditions: exact}", "17:22", "use conditions: natural"),
        ("grid: 12}", "grid: 12, basis: legendre}", "16:46", "use web-spline"),
    ],
)
def test_inclusions_that_cannot_be(folder, old, new, place, words):
    assert MATERIALS.count(old) == 1
    refuse(folder, MATERIALS.replace(old, new), place, words)
