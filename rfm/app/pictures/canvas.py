"""Figures of one look, drawn by the Agg canvas without any global state."""

from __future__ import annotations

import io
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from rfm.calculus.types import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

DPI = 130
INK, FAINT, PAPER = "#1b2733", "#8a95a1", "#ffffff"
FIELD_MAP, ERROR_MAP = "viridis", "RdBu_r"

CELL_COLOURS = {1: "#cfe3f1", 0: "#f6c667", -1: "#f1f1ef"}
"""Colour of a cell by its state: inner, cut, outer."""

PART_COLOURS = ("#b3263e", "#14618f", "#1c7c54", "#7b3fa0", "#c05a00", "#4a4a8c", "#8c6d1f", "#0f7f86")

TICKS = 6
"""Ticks of an axis, about: drawing them takes most of the time of a picture."""

LEFT, RIGHT, TOP, BOTTOM, BAR = 0.62, 0.95, 0.5, 0.45, 0.16
"""Margins and the width of a colour bar, in inches."""


@dataclass(frozen=True)
class Frame:
    """A figure with one main axes of equal aspect and, beside it, the axes of a colour bar."""

    figure: Figure
    axes: Axes
    bar: Axes | None


def colour_bar(drawn: Any, axes: Axes, size: float = 8) -> None:
    """Explain the colours of `drawn` in `axes`."""
    from matplotlib.ticker import MaxNLocator, ScalarFormatter

    numbers = ScalarFormatter()
    numbers.set_powerlimits((-3, 4))
    axes.figure.colorbar(drawn, cax=axes, format=numbers, ticks=MaxNLocator(TICKS))
    for spine in axes.spines.values():
        spine.set_visible(False)
    axes.tick_params(labelsize=size, length=2, color=FAINT, labelcolor=INK)
    axes.yaxis.get_offset_text().set_fontsize(size)


def frame(title: str, lower: Array, upper: Array, *, bar: bool = True, right: float = RIGHT) -> Frame:
    """Figure for a region of the plane from `lower` to `upper`, to scale, with a `right` margin."""
    width, height = (float(high - low) for low, high in zip(lower, upper, strict=True))
    inches = 5.2 / max(width, height)
    across, up = max(width * inches, 1.8), max(height * inches, 1.2)
    size = (LEFT + across + right, BOTTOM + up + TOP)
    figure = new_figure(size)
    axes = figure.add_axes((LEFT / size[0], BOTTOM / size[1], across / size[0], up / size[1]))
    axes.set_aspect("equal")
    axes.set_xlim(lower[0], upper[0])
    axes.set_ylim(lower[1], upper[1])
    axes.locator_params(nbins=TICKS)
    tidy(axes)
    heading(axes, title)
    bar_axes = None
    if bar:
        x = (LEFT + across + 0.14) / size[0]
        bar_axes = figure.add_axes((x, BOTTOM / size[1], BAR / size[0], up / size[1]))
    return Frame(figure, axes, bar_axes)


def new_figure(size: tuple[float, float]) -> Figure:
    """Return an empty figure of `size` inches with its own Agg canvas."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=size, dpi=DPI, facecolor=PAPER)
    FigureCanvasAgg(figure)
    return figure


def heading(axes: Axes, title: str, size: float = 11) -> None:
    """Put `title` above `axes`, as plain text whatever characters it has."""
    axes.set_title(title, fontsize=size, color=INK, loc="left", y=1.0, pad=8, parse_math=False)


def tidy(axes: Axes) -> None:
    """Give `axes` the common look: thin pale frame, small ticks."""
    axes.tick_params(labelsize=8, length=2.5, color=FAINT, labelcolor=INK)
    for spine in axes.spines.values():
        spine.set(color=FAINT, linewidth=0.6)


def png_bytes(figure: Figure) -> bytes:
    """Render `figure` as PNG."""
    from PIL import Image

    canvas: Any = figure.canvas
    canvas.draw()
    stream = io.BytesIO()
    opaque = Image.fromarray(np.asarray(canvas.buffer_rgba())).convert("RGB")  # a quarter less to compress
    opaque.save(stream, format="png", dpi=(DPI, DPI), compress_level=1)
    return stream.getvalue()


def limits(values: Any, *, symmetric: bool = False) -> tuple[float, float]:
    """Range of colours for `values`: their finite range, never empty; around zero when symmetric."""
    finite = np.asarray(values)[np.isfinite(values)]
    if not len(finite):
        return -1.0, 1.0
    low, high = float(finite.min()), float(finite.max())
    if symmetric:
        high = max(abs(low), abs(high)) or 1e-300
        return -high, high
    if high - low <= 1e-12 * max(abs(low), abs(high), 1e-300):
        margin = 0.5 * abs(high) or 0.5
        return low - margin, high + margin
    return low, high


def short_number(value: float) -> str:
    """`value` with two digits, as ``1.2e-9``; plain between 0.01 and 1000."""
    if value == 0 or not math.isfinite(value):
        return f"{value:g}"
    if 1e-2 <= abs(value) < 1e3:
        return f"{value:.3g}"
    mantissa, exponent = f"{value:.1e}".split("e")
    return f"{mantissa}e{int(exponent)}"
