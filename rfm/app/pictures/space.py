"""Pictures of fields in space: a solid cut open, and three plane sections."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from rfm.app.fitted import FittedMesh
from rfm.app.pictures.canvas import INK, colour_bar, limits, new_figure
from rfm.app.pictures.cutaway import AZIMUTH, ELEVATION, cut_open, middle_of, view
from rfm.app.pictures.render import Image, View
from rfm.app.pictures.slices import NAMES, Section, draw_values, section
from rfm.calculus.types import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from rfm.app.record import PointFunction, RunRecord

PIXELS = 620
"""Longer side of the rendered solid."""

PLANES = ((0, 2, 1), (1, 2, 0), (0, 1, 2))
"""Axes across, upward and constant of the three sections."""

WIDTH, HEIGHT = 8.6, 5.0


@dataclass(frozen=True)
class Solid:
    """A solid prepared for pictures: what is seen of it is found once for all its fields."""

    record: RunRecord

    @cached_property
    def mesh(self) -> FittedMesh:
        """Boundary of the solid cut open."""
        return cut_open(self.record)

    @cached_property
    def view(self) -> View:
        """What the eye sees of it."""
        return view(self.mesh, PIXELS)

    @cached_property
    def sections(self) -> tuple[Section, ...]:
        """Three plane sections through its middle."""
        box, grid = self.record.domain.box, self.record.grid
        lower = np.maximum(grid.lower, box.lower)
        upper = np.minimum(grid.lower + grid.spacing * grid.cells, box.upper)
        middle = np.array(middle_of(self.record))
        return tuple(section(self.record.domain, lower, upper, middle, axes) for axes in PLANES)

    def at_corners(self, function: PointFunction) -> Array:
        """Values (nf, 3) of `function` at the corners of the facets, each point evaluated once."""
        used, place = np.unique(self.mesh.facets, return_inverse=True)
        values = np.asarray(function(self.mesh.points[used]), dtype=np.float64)
        return values[place.reshape(self.mesh.facets.shape)]


def field_3d(solid: Solid, function: PointFunction, title: str, colour_map: str, symmetric: bool) -> Figure:
    """Picture of a field on the solid cut open and in the sections, on one scale of colours."""
    import matplotlib as mpl
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    corner_values = solid.at_corners(function)
    section_values = [plane.sampled(function) for plane in solid.sections]
    inside = [
        values[plane.membership > 0] for plane, values in zip(solid.sections, section_values, strict=True)
    ]
    low, high = limits(np.concatenate([corner_values.ravel(), *inside]), symmetric=symmetric)
    table = np.asarray(mpl.colormaps[colour_map](np.linspace(0, 1, 256)))[:, :3]
    image = solid.view.image(corner_values, table, (low, high))

    def panel(axes: Axes, number: int) -> None:
        draw_values(
            axes, solid.sections[number], section_values[number], cmap=colour_map, vmin=low, vmax=high
        )

    figure, right = composed(solid, image, title, panel)
    bar_axes = figure.add_axes((right + 0.01, 0.16, 0.016, 0.68))
    colour_bar(ScalarMappable(Normalize(low, high), colour_map), bar_axes, size=7.5)
    return figure


def composed(
    solid: Solid, image: Image, title: str, panel: Callable[[Any, int], None], extra: float = 0.0
) -> tuple[Figure, float]:
    """Figure with the rendered `image` on the left and three panels beside it.

    Returns
    -------
    figure, right
        The figure, `extra` inches wider than usual, and where its free right margin begins.
    """
    width = WIDTH + extra
    share = WIDTH / width
    figure = new_figure((width, HEIGHT))
    left = figure.add_axes((0.01 * share, 0.02, 0.60 * share, 0.88))
    left.imshow(image, interpolation="bilinear")
    left.set_axis_off()
    _triad(figure)
    figure.text(0.02 * share, 0.945, title, fontsize=11, color=INK, parse_math=False)
    for number in range(len(PLANES)):
        axes = figure.add_axes((0.665 * share, 0.08 + (2 - number) * 0.312, 0.225 * share, 0.225))
        panel(axes, number)
    return figure, 0.915 * share


def _triad(figure: Figure) -> None:
    """Draw the directions of the axes in the lower left corner."""
    a, e = np.radians([AZIMUTH, ELEVATION])
    right = np.array([-np.sin(a), np.cos(a), 0.0])
    toward = np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
    up = np.cross(toward, right)
    width, height = figure.get_size_inches()
    axes = figure.add_axes((0.0, 0.0, 1.1 / width, 1.1 / height))
    axes.set_axis_off()
    axes.set_xlim(-1.3, 1.3)
    axes.set_ylim(-1.3, 1.3)
    for axis in range(3):
        x, y = float(right[axis]), float(up[axis])
        axes.plot([0, 0.8 * x], [0, 0.8 * y], color=INK, linewidth=1.1, solid_capstyle="round")
        axes.text(1.08 * x, 1.08 * y, NAMES[axis], fontsize=8, color=INK, ha="center", va="center")
