"""Plane sections through a solid: values on a fine raster, clipped at the boundary."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from rfm.app.pictures.canvas import INK, tidy
from rfm.calculus.types import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from rfm.app.record import PointFunction
    from rfm.geometry.shape import Shape

RASTER = 160
"""Points along the longer side of a section."""

NAMES = "xyz"


@dataclass(frozen=True)
class Section:
    """A raster of points (r, c) in a plane through a solid.

    Attributes
    ----------
    axes
        Coordinates across, upward, and the one that is constant.
    ticks
        Coordinates of the columns and of the rows.
    membership
        Positive inside (r, c).
    points
        Shape (r, c, 3).
    """

    axes: tuple[int, int, int]
    ticks: tuple[Array, Array]
    membership: Array
    points: Array

    @property
    def title(self) -> str:
        """Equation of the plane."""
        return f"{NAMES[self.axes[2]]} = {self.points[0, 0, self.axes[2]]:.3g}"

    def sampled(self, function: PointFunction) -> Array:
        """Values (r, c) of `function` inside, continued a little beyond the boundary."""
        inside = self.membership > 0
        values = np.full(inside.shape, np.nan)
        if inside.any():
            values[inside] = function(self.points[inside])
        return _continued(_continued(values))


def section(domain: Shape, lower: Array, upper: Array, middle: Array, axes: tuple[int, int, int]) -> Section:
    """Raster of the plane through `middle` on which coordinate ``axes[2]`` is constant."""
    across, upward, constant = axes
    longest = max(upper[across] - lower[across], upper[upward] - lower[upward])
    ticks = []
    for axis in (across, upward):
        margin = 0.03 * longest
        count = max(8, int(np.ceil(RASTER * (upper[axis] - lower[axis]) / longest)))
        ticks.append(np.linspace(lower[axis] - margin, upper[axis] + margin, count))
    grid = np.meshgrid(*ticks)
    points = np.empty((*grid[0].shape, 3))
    points[..., across], points[..., upward] = grid
    points[..., constant] = middle[constant]
    coords = tuple(np.ascontiguousarray(points[..., k]) for k in range(3))
    with np.errstate(all="ignore"):
        membership = np.broadcast_to(domain.membership(*coords), grid[0].shape)
    return Section(axes, (ticks[0], ticks[1]), np.nan_to_num(membership, nan=-1.0), points)


def draw_values(panel: Axes, plane: Section, values: Array, **colours: Any) -> None:
    """Draw `values` of a section, cut off at the boundary."""
    inside = _outline(panel, plane)
    image = panel.imshow(
        np.ma.masked_invalid(values),
        origin="lower",
        extent=_extent(plane),
        interpolation="bilinear",
        aspect="equal",
        **colours,
    )
    if inside is not None:
        image.set_clip_path(inside, transform=panel.transData)
    _finish(panel, plane)


def draw_cells(panel: Axes, plane: Section, edges: tuple[Array, Array], colours: NDArray[Any]) -> None:
    """Draw cells (r, c, 3) of the grid in a section with the boundary over them."""
    draw_grid(panel, edges, colours)
    _outline(panel, plane)
    panel.set_aspect("equal")
    _finish(panel, plane)


def draw_grid(panel: Axes, edges: tuple[Array, Array], colours: NDArray[Any]) -> None:
    """Fill cells (r, c, 3) between `edges` and draw thin lines between them."""
    from matplotlib.collections import LineCollection

    x, y = edges
    panel.pcolormesh(x, y, colours)
    upright = [((value, y[0]), (value, y[-1])) for value in x]
    level = [((x[0], value), (x[-1], value)) for value in y]
    width = float(np.clip(20.0 / max(len(x), len(y)), 0.15, 0.8))
    lines = LineCollection(upright + level, colors="white", linewidths=width, snap=False)
    panel.add_collection(lines, autolim=False)


def _extent(plane: Section) -> tuple[float, float, float, float]:
    (x, y), half = plane.ticks, 0.5
    dx, dy = half * (x[1] - x[0]), half * (y[1] - y[0])
    return float(x[0] - dx), float(x[-1] + dx), float(y[0] - dy), float(y[-1] + dy)


def _outline(panel: Axes, plane: Section) -> Any:
    """Draw the boundary; its path, or None when the plane misses the solid."""
    if not (plane.membership > 0).any():
        return None
    lines = panel.contour(*plane.ticks, plane.membership, levels=[0.0], colors=INK, linewidths=0.9)
    return lines.get_paths()[0]


def _finish(panel: Axes, plane: Section) -> None:
    panel.set_xlim(plane.ticks[0][0], plane.ticks[0][-1])
    panel.set_ylim(plane.ticks[1][0], plane.ticks[1][-1])
    tidy(panel)
    panel.locator_params(nbins=4)
    panel.tick_params(labelsize=6.5, pad=2)
    panel.set_xlabel(NAMES[plane.axes[0]], fontsize=7.5, labelpad=0, color=INK)
    panel.set_ylabel(NAMES[plane.axes[1]], fontsize=7.5, labelpad=3, color=INK)
    panel.set_title(plane.title, fontsize=8, color=INK, loc="left", y=1.0, pad=3)


def _continued(values: Array) -> Array:
    """Give the missing points next to known ones the mean of their known neighbours."""
    padded = np.pad(values, 1, constant_values=np.nan)
    known = np.isfinite(padded)
    total, count = np.zeros_like(values), np.zeros(values.shape)
    rows, columns = values.shape
    for i in range(3):
        for j in range(3):
            near = (slice(i, i + rows), slice(j, j + columns))
            total += np.where(known[near], padded[near], 0.0)
            count += known[near]
    mean = np.where(count > 0, total / np.maximum(count, 1), np.nan)
    return np.where(np.isfinite(values), values, mean)
