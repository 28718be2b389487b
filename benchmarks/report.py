"""Tables and plots of the rows: ``python -m benchmarks.report [PAGES]`` writes them anew from the JSON."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from benchmarks.problems import PROBLEMS
from benchmarks.record import PHASES, TOLERANCES, Row, by_series, exponent, reached

RESULTS = Path(__file__).resolve().parent / "results"
COLORS = {
    "rfm": "#c0392b",
    "NGSolve": "#1f4e79",
    "ngsxfem": "#5b9bd5",
    "scikit-fem": "#2e8b57",
    "nutils": "#b8860b",
}
MESHED = ("NGSolve", "scikit-fem")
"""Programs on a mesh that follows the boundary."""
UNFITTED = "ngsxfem"
"""The nearest relative: it cuts a mesh that does not follow the boundary."""


def rows_of(rows: Iterable[Row], problem: str, program: str) -> list[Row]:
    """Rows of one program on one problem."""
    return [row for row in rows if (row.problem, row.program) == (problem, program)]


def names(rows: Iterable[Row]) -> tuple[list[str], list[str]]:
    """Problems and programs in the order of their rows."""
    rows = list(rows)
    return list(dict.fromkeys(r.problem for r in rows)), list(dict.fromkeys(r.program for r in rows))


def table(header: Sequence[str], lines: Iterable[Sequence[str]]) -> list[str]:
    """Markdown table."""
    shown = [header, ["---"] * len(header), *lines]
    return ["| " + " | ".join(line) + " |" for line in shown]


def seconds(value: float) -> str:
    """Three decimals below a second, else one."""
    return f"{value:.3f}" if value < 1 else f"{value:.1f}"


def count(value: float) -> str:
    """Whole number, in thousands when large."""
    return f"{value:.0f}" if value < 10_000 else f"{value / 1000:.0f}k"


def cell(rows: list[Row], tolerance: float) -> str:
    """What a tolerance takes."""
    best = reached(rows, tolerance)
    if best is None:
        return "–"
    bound = "≤ " if best.coarsest else ""
    fewest = f"; fewest {count(best.fewest_unknowns)}" if best.fewest_series != best.series else ""
    return f"{bound}{seconds(best.seconds)} s / {count(best.unknowns)} ({best.series}{fewest})"


def nearest(rows: list[Row]) -> str:
    """The smallest error reached."""
    best = min(rows, key=lambda row: row.error)
    return f"{best.error:.0e} in {seconds(best.total)} s"


def summary(rows: Sequence[Row]) -> list[str]:
    """Markdown: what each program needs for each tolerance."""
    problems, programs = names(rows)
    lines = []
    for problem in problems:
        for program in programs:
            mine = rows_of(rows, problem, program)
            if mine:
                lines.append([problem, program, *(cell(mine, t) for t in TOLERANCES), nearest(mine)])
    return table(["problem", "program", *(f"{t:.0e}" for t in TOLERANCES), "smallest error"], lines)


def share(part: float, whole: float) -> str:
    """One count by another: ``1/15``, or two decimals where it is no small part."""
    return f"1/{whole / part:.0f}" if whole >= 1.95 * part else f"{part / whole:.2f}"


def against(rows: Sequence[Row]) -> list[str]:
    """Markdown: rfm by the best of the others, seconds, and by the frugal one of those on fitted meshes, unknowns."""
    problems, programs = names(rows)
    others = [program for program in programs if program != "rfm"]
    lines = []
    for problem in problems:
        line = [problem]
        for tolerance in TOLERANCES:
            mine = reached(rows_of(rows, problem, "rfm"), tolerance)
            found = {name: reached(rows_of(rows, problem, name), tolerance) for name in others}
            rivals = {name: best for name, best in found.items() if best}
            if mine is None or not rivals:
                line.append("only rfm" if mine else "–" if not rivals else "only others")
                continue
            name = min(rivals, key=lambda one: rivals[one].seconds)
            text = f"{mine.seconds / rivals[name].seconds:.2f} of {name}"
            if UNFITTED in rivals and name != UNFITTED:
                text += f", {mine.seconds / rivals[UNFITTED].seconds:.2f} of {UNFITTED}"
            fitted = [rivals[one].fewest_unknowns for one in MESHED if one in rivals]
            if fitted:
                text += f"; unknowns {share(mine.unknowns, min(fitted))}"
                if mine.fewest_series != mine.series:
                    text += f" (fewest {share(mine.fewest_unknowns, min(fitted))})"
            line.append(text)
        lines.append(line)
    return table(["problem", *(f"{t:.0e}" for t in TOLERANCES)], lines)


def splits(rows: Sequence[Row], tolerance: float = 1e-6) -> list[str]:
    """Markdown: where the time goes in the fastest solve that reaches a tolerance, else in the most accurate one."""
    problems, programs = names(rows)
    lines = []
    for problem in problems:
        for program in programs:
            mine = rows_of(rows, problem, program)
            if not mine:
                continue
            good = [row for row in mine if row.error <= tolerance]
            row = min(good, key=lambda one: one.total) if good else min(mine, key=lambda one: one.error)
            lines.append(
                [
                    problem, program, row.series, count(row.unknowns), f"{row.error:.0e}",
                    *(f"{row.seconds.get(phase, 0.0):.3f}" for phase in PHASES), seconds(row.total),
                    seconds(row.first), seconds(row.processor), f"{row.memory_mb:.0f}",
                ]
            )  # fmt: skip
    header = ["problem", "program", "series", "unknowns", "error", *PHASES, "all", "first", "processor", "MB"]
    return table(header, lines)


def growth(rows: Sequence[Row]) -> list[str]:
    """Markdown: exponents of time and memory against the unknowns, of the solves of more than 10^4 unknowns."""
    lines = []
    problems, programs = names(rows)
    for problem in problems:
        for name, part in by_series(rows_of(rows, problem, programs[0])).items():
            large = [row for row in part if row.unknowns >= 10_000]
            if len(large) < 2:
                continue
            unknowns = [float(row.unknowns) for row in large]
            costs = [*([max(row.seconds[phase], 1e-6) for row in large] for phase in PHASES)]
            costs += [[row.total for row in large], [max(row.memory_mb, 1e-3) for row in large]]
            last = large[-1]
            lines.append(
                [
                    problem, name, f"{unknowns[0]:.0f} to {unknowns[-1]:.0f}",
                    *(f"{exponent(unknowns, cost):.2f}" for cost in costs),
                    f"{last.total:.1f} s, {last.memory_mb:.0f} MB, {last.error:.0e}",
                    f"{1e6 * last.total / last.unknowns:.1f} µs, {1024 * last.memory_mb / last.unknowns:.1f} kB",
                ]
            )  # fmt: skip
    return table(["problem", "series", "unknowns", *PHASES, "all", "memory", "largest", "an unknown"], lines)


def frontier(rows: Iterable[Row]) -> list[Row]:
    """Rows that no other beats in both time and error, slowest first."""
    kept: list[Row] = []
    for row in sorted(rows, key=lambda one: one.total):
        if not kept or row.error < kept[-1].error:
            kept.append(row)
    return kept[::-1]


def plot(rows: Sequence[Row], problem: str, path: Path) -> None:
    """Time to accuracy of all programs on a problem; faint dots are the solves that another beats."""
    import matplotlib as mpl

    mpl.use("Agg")
    from matplotlib import pyplot as plt

    figure, (left, right) = plt.subplots(1, 2, figsize=(7.2, 3.1), sharey=True, layout="constrained")
    for program in names(rows)[1]:
        mine = rows_of(rows, problem, program)
        if not mine:
            continue
        color = COLORS.get(program, "black")
        front = frontier(mine)
        left.loglog([r.total for r in mine], [r.error for r in mine], ".", ms=3, color=color, alpha=0.3)
        left.loglog(
            [r.total for r in front], [r.error for r in front], "o-", ms=3, lw=1.2, color=color, label=program
        )
        right.loglog([r.unknowns for r in mine], [r.error for r in mine], ".", ms=4, color=color, alpha=0.6)
    for axes, label in ((left, "seconds"), (right, "unknowns")):
        axes.set_xlabel(label)
        whole_decades(axes)
    left.set_ylim(1e-10, 1)
    left.set_ylabel("relative L2 error")
    left.legend(fontsize=7, frameon=False, loc="lower left")
    figure.suptitle(problem, fontsize=10)
    figure.savefig(path, dpi=100)
    plt.close(figure)
    quantise(path)


def plot_growth(rows: Sequence[Row], path: Path) -> None:
    """Time by phase and memory against the unknowns."""
    import matplotlib as mpl

    mpl.use("Agg")
    from matplotlib import pyplot as plt

    figure, (left, right) = plt.subplots(1, 2, figsize=(7.2, 3.1), layout="constrained")
    for problem in names(rows)[0]:
        for series, part in by_series(rows_of(rows, problem, names(rows)[1][0])).items():
            unknowns = [row.unknowns for row in part]
            left.loglog(
                unknowns, [row.total for row in part], "o-", ms=3, lw=1.2, label=f"{problem}, {series}"
            )
            right.loglog(unknowns, [row.memory_mb for row in part], "o-", ms=3, lw=1.2)
    for axes, label in ((left, "seconds"), (right, "MB")):
        axes.set_xlabel("unknowns")
        axes.set_ylabel(label)
        whole_decades(axes)
        axes.set_ylim(*decades(axes.get_ylim()))
    left.legend(fontsize=7, frameon=False)
    figure.savefig(path, dpi=100)
    plt.close(figure)
    quantise(path)


def decades(limits: tuple[float, float]) -> tuple[float, float]:
    """Powers of ten around an interval."""
    return 10.0 ** math.floor(math.log10(limits[0])), 10.0 ** math.ceil(math.log10(limits[1]))


def whole_decades(axes: Any) -> None:
    """Let the horizontal axis begin and end at powers of ten, and draw those only."""
    axes.set_xlim(*decades(axes.get_xlim()))
    axes.grid(True, which="major", lw=0.4, alpha=0.6)


def quantise(path: Path) -> None:
    """Make a picture small; the colors of thin lines are kept."""
    from PIL import Image

    with Image.open(path) as picture:
        small = picture.convert("RGB").quantize(128, method=Image.Quantize.MAXCOVERAGE)
    small.save(path, optimize=True)


def load(path: Path) -> tuple[list[Row], Mapping[str, Any]]:
    """Rows of a file of results, and the rest of it."""
    content = json.loads(path.read_text())
    rows = [
        Row(**{key: value for key, value in row.items() if key != "total"}) for row in content.pop("rows")
    ]
    return rows, content


HEAD = """# Benchmarks

Written by `make bench-peers` and `make bench-large`; how it is measured, and what to read from it, is in
[performance.md](performance.md). Disk eigenvalues are left out as long as rfm has no eigenvalue equation.
"""

READING = """
Seconds / unknowns to reach a relative L2 error, interpolated along a series, by the fastest series (in brackets, with
the fewest unknowns of any series where that is another). "≤": already the coarsest solve of that series is more
accurate. "–": not reached within the limit.
"""

RATIOS = """
Seconds of rfm by those of the fastest other program and of ngsxfem, and its unknowns (of its fastest series; in
brackets those of its most frugal one) by the fewest of a program on a fitted mesh:
"""

SPLITS = """
The fastest solve below 1e-6, or where there is none the most accurate one: wall seconds by phase (a mesh, and cutting,
count as geometry; quadrature of the others is part of assembly), of all phases, of the first call, processor seconds,
and memory beyond the imports. Unknowns of NGSolve are all those of the space, condensed ones as well.
"""

GROWTH = """
Exponents of the unknowns that fit wall seconds by phase and peak memory, from 10^4 unknowns on, and the largest solve:
"""


def machine(content: Mapping[str, Any]) -> str:
    """What the rows were measured on."""
    settings = content["settings"]
    versions = {name: version for one in content["versions"].values() for name, version in one.items()}
    listed = ", ".join(f"{name} {version}" for name, version in versions.items())
    host = f"{settings['system']}, {settings['cores']} cores, {settings['threads']} threads"
    return f"{host}, limit {settings['limit']:g} s; {listed}. {settings['remark']}".strip()


def ended_early(notes: Iterable[str]) -> list[str]:
    """List by problem and program of the series that time ended."""
    found: dict[str, list[str]] = {}
    for note in notes:
        place, program, rest = note.rsplit("|", 2)
        if "budget" in rest or "not done" in rest:
            found.setdefault(f"{place}, {program}", []).append(rest.partition(": ")[0].partition(", {")[0])
    lines = [f"- {place}: {'; '.join(dict.fromkeys(series))}" for place, series in found.items()]
    return ["Series that were ended by time, some before their first solve:\n", *lines, ""] if lines else []


def write(results: Path, pages: Path) -> None:
    """Write the page and its plots from the files of results that are there."""
    text = [HEAD]
    pictures = pages / "pictures"
    pictures.mkdir(parents=True, exist_ok=True)
    if (results / "peers.json").exists():
        rows, content = load(results / "peers.json")
        text += ["## Beside other programs\n", machine(content), READING, *summary(rows)]
        text += [RATIOS, *against(rows), "\n## Where the time goes", SPLITS, *splits(rows), ""]
        text += ["## Time to accuracy\n"]
        for problem in PROBLEMS:
            if any(row.problem == problem.name for row in rows):
                picture = pictures / f"benchmark_{problem.slug}.png"
                plot(rows, problem.name, picture)
                text += [
                    f"![{problem.name}: error over seconds and over unknowns](pictures/{picture.name})\n"
                ]
        text += ended_early(content["notes"])
    if (results / "large.json").exists():
        rows, content = load(results / "large.json")
        picture = pictures / "benchmark_growth.png"
        plot_growth(rows, picture)
        text += ["## Growth of the cost\n", machine(content), GROWTH, *growth(rows), ""]
        text += [f"![Seconds and memory over unknowns](pictures/{picture.name})", ""]
    (pages / "benchmarks.md").write_text("\n".join(text).rstrip() + "\n")


if __name__ == "__main__":
    write(RESULTS, Path(sys.argv[1] if len(sys.argv) > 1 else "docs"))
