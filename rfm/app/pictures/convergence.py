"""The convergence plot of a study: relative error against the cells along the longest side."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from rfm.app.pictures.canvas import FAINT, INK, PART_COLOURS, heading, new_figure, tidy

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

ERRORS = (("relative_l2_error", "relative L² error", 1), ("relative_h1_error", "relative H¹ error", 0))
"""Key in a row, label, and what is added to the degree to give the expected order."""


def convergence(rows: Sequence[Mapping[str, Any]], title: str) -> Figure | None:
    """Picture of the errors in `rows` by degree; None when there is nothing to plot."""
    kinds = [kind for kind in ERRORS if any(_usable(row, kind[0]) for row in rows)]
    if not kinds:
        return None
    figure = new_figure((0.6 + 4.3 * len(kinds), 3.9))
    panels = figure.subplots(1, len(kinds), squeeze=False)[0]
    for axes, (key, label, raised) in zip(panels, kinds, strict=True):
        _panel(axes, rows, key, label, raised)
    panels[0].legend(fontsize=8, frameon=False, title="degree", title_fontsize=8)
    figure.suptitle(title, fontsize=11, color=INK, x=0.02, ha="left", parse_math=False)
    width = figure.get_size_inches()[0]
    figure.subplots_adjust(left=0.75 / width, right=1 - 0.15 / width, bottom=0.13, top=0.88, wspace=0.27)
    return figure


def _usable(row: Mapping[str, Any], key: str) -> bool:
    value = row.get(key)
    return value is not None and value > 0 and np.isfinite(value) and row.get("grid") is not None


def _panel(axes: Axes, rows: Sequence[Mapping[str, Any]], key: str, label: str, raised: int) -> None:
    from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator, StrMethodFormatter

    usable = [row for row in rows if _usable(row, key)]
    degrees = sorted({int(row["degree"]) for row in usable})
    for number, degree in enumerate(degrees):
        pairs = sorted((float(row["grid"]), float(row[key])) for row in usable if row["degree"] == degree)
        grid, error = np.array(pairs).T
        colour = PART_COLOURS[number % len(PART_COLOURS)]
        axes.loglog(grid, error, "o-", color=colour, markersize=4, linewidth=1.4, label=f"{degree}")
        if len(grid) > 1:
            expected = error[0] * (grid / grid[0]) ** -(degree + raised)
            shown = expected > 0.2 * error.min()
            axes.loglog(grid[shown], expected[shown], "--", color=FAINT, linewidth=0.8, zorder=1)
    ticks = sorted({float(row["grid"]) for row in usable})
    axes.xaxis.set_major_locator(FixedLocator(ticks))
    axes.xaxis.set_minor_locator(NullLocator())
    axes.xaxis.set_major_formatter(StrMethodFormatter("{x:.0f}"))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"1e{round(np.log10(value))}"))
    axes.yaxis.set_minor_locator(NullLocator())
    axes.set_xlabel("cells along the longest side", fontsize=9, color=INK)
    heading(axes, f"{label}  (dashed: order {'p+1' if raised else 'p'})", 9)
    axes.grid(True, which="major", color="#e3e6e9", linewidth=0.6)
    tidy(axes)
