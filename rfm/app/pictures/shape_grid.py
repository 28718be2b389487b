"""The shape on its grid: inner, cut and outer cells, and the named parts of its boundary."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from rfm.app.fitted import FittedMesh
from rfm.app.pictures.canvas import CELL_COLOURS, FAINT, INK, frame
from rfm.app.pictures.parts import NamedFacets, named_facets
from rfm.app.pictures.slices import draw_cells, draw_grid
from rfm.app.pictures.space import PLANES, Solid, composed
from rfm.calculus.types import Array

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from rfm.app.record import RunRecord
    from solvers.grid import Grid

LISTED = 14
"""Parts named in the legend, at most."""

STATES = ((1, "inner cells"), (0, "cut cells"), (-1, "outer cells"))


def shape_2d(record: RunRecord, mesh: FittedMesh, title: str) -> Figure:
    """Picture of a plane shape on its grid."""
    from matplotlib.collections import LineCollection

    grid = record.grid
    upper = grid.lower + grid.spacing * grid.cells
    margin = 0.03 * float((upper - grid.lower).max())
    parts = named_facets(mesh)
    picture = frame(title, grid.lower - margin, upper + margin, bar=False, right=2.0)
    across = _edges(grid, 0), _edges(grid, 1)
    cells = _cell_colours(record.classification.state).transpose(1, 0, 2)
    draw_grid(picture.axes, across, cells)
    colours = [parts.colour(int(number)) for number in parts.number]
    segments = LineCollection(list(mesh.points[mesh.facets]), colors=colours, linewidths=2.0)
    segments.set_capstyle("round")
    picture.axes.add_collection(segments, autolim=False)
    marked = np.array([one.points[0] for one in record.singularities]).reshape(-1, 2)
    picture.axes.plot(*marked.T, "o", color=INK, markersize=3.5, markerfacecolor="white", zorder=5)
    beside = picture.axes.get_position()
    place = (beside.x1 + 0.15 / float(picture.figure.get_size_inches()[0]), beside.y1)
    _legend(picture.figure, parts, record.classification.state, place)
    return picture.figure


def shape_3d(record: RunRecord, solid: Solid, title: str) -> Figure:
    """Picture of a solid cut open, its parts in colours, with the cells in three sections."""
    from matplotlib.colors import to_rgb

    parts = named_facets(solid.mesh)
    faces = [name == "" for name in parts.names]  # the faces of the cut have no name
    table = np.array([to_rgb("#c9ccd1" if face else parts.colour(k)) for k, face in enumerate(faces)])
    table = np.concatenate([table, table[-1:]])
    image = solid.view.image(
        np.repeat(parts.number[:, None], 3, axis=1).astype(float), table, (0.0, len(table) - 1.0)
    )

    def panel(axes: Any, number: int) -> None:
        plane, grid = solid.sections[number], record.grid
        across, upward, constant = PLANES[number]
        place = (plane.points[0, 0, constant] - grid.lower[constant]) / grid.spacing[constant]
        layer = int(np.clip(np.floor(place), 0, grid.cells[constant] - 1))
        states = np.take(record.classification.state, layer, axis=constant)
        states = states if across > upward else states.T
        draw_cells(axes, plane, (_edges(grid, across), _edges(grid, upward)), _cell_colours(states))

    figure, right = composed(solid, image, title, panel, extra=1.3)
    _legend(figure, parts, record.classification.state, (right, 0.9))
    return figure


def _edges(grid: Grid, axis: int) -> Array:
    return np.asarray(grid.lower[axis] + grid.spacing[axis] * np.arange(int(grid.cells[axis]) + 1))


def _cell_colours(states: Any) -> Array:
    from matplotlib.colors import to_rgb

    table = np.array([to_rgb(CELL_COLOURS[state]) for state in (-1, 0, 1)])
    return np.asarray(table[np.asarray(states, dtype=int) + 1])


def _legend(figure: Any, parts: NamedFacets, states: Any, place: tuple[float, float]) -> None:
    """Say what the colours mean, and how many cells there are of each state."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    entries: list[Any] = [
        Patch(facecolor=CELL_COLOURS[state], edgecolor=FAINT, label=f"{int((states == state).sum())} {text}")
        for state, text in STATES
    ]
    named = [(number, name) for number, name in enumerate(parts.names) if name]
    entries += [
        Line2D([], [], color=parts.colour(number), linewidth=2.5, label=name)
        for number, name in named[:LISTED]
    ]
    if len(named) > LISTED:
        entries.append(Line2D([], [], linestyle="", label=f"and {len(named) - LISTED} more"))
    legend = figure.legend(
        handles=entries,
        loc="upper left",
        bbox_to_anchor=place,
        fontsize=8,
        frameon=False,
        labelcolor=INK,
        borderaxespad=0,
    )
    for text in legend.get_texts():
        text.set_parse_math(False)
