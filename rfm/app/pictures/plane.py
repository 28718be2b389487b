"""Pictures of fields in the plane, on the fitted mesh with the exact boundary."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rfm.app.pictures.canvas import ERROR_MAP, FIELD_MAP, INK, Frame, colour_bar, frame, limits
from rfm.calculus.types import Array

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from matplotlib.tri import Triangulation

    from rfm.app.fitted import FittedMesh

LEVELS = 12
"""Isolines of the solution."""


def field_2d(mesh: FittedMesh, values: Array, title: str) -> Figure:
    """Picture of `values` at the points of `mesh` with isolines and the boundary."""
    low, high = limits(values)
    picture = _coloured(mesh, values, title, (low, high), FIELD_MAP)
    finite = values[np.isfinite(values)]
    if len(finite) and np.ptp(finite) > 1e-12 * max(abs(low), abs(high)):
        levels = np.linspace(low, high, LEVELS + 2)[1:-1]
        picture.axes.tricontour(
            _triangulation(mesh),
            np.nan_to_num(values),
            levels=levels,
            colors="white",
            linewidths=0.5,
            linestyles="solid",
            alpha=0.55,
        )
    draw_boundary(picture, mesh)
    return picture.figure


def error_2d(mesh: FittedMesh, error: Array, title: str) -> Figure:
    """Picture of a signed `error`, zero in white."""
    picture = _coloured(mesh, error, title, limits(error, symmetric=True), ERROR_MAP)
    draw_boundary(picture, mesh)
    return picture.figure


def draw_boundary(picture: Frame, mesh: FittedMesh, colour: str = INK, width: float = 1.1) -> None:
    """Draw the boundary facets of `mesh` as lines."""
    from matplotlib.collections import LineCollection

    segments = mesh.points[mesh.facets]
    lines = LineCollection(list(segments), colors=colour, linewidths=width, capstyle="round")
    picture.axes.add_collection(lines, autolim=False)


def view_box(points: Array, margin: float = 0.04) -> tuple[Array, Array]:
    """Lower and upper corner of the region around `points`, with a margin."""
    lower, upper = points.min(axis=0), points.max(axis=0)
    pad = margin * float((upper - lower).max())
    return lower - pad, upper + pad


def _coloured(
    mesh: FittedMesh, values: Array, title: str, colours: tuple[float, float], colour_map: str
) -> Frame:
    picture = frame(title, *view_box(mesh.points))
    drawn = picture.axes.tripcolor(
        _triangulation(mesh),
        np.nan_to_num(values),
        shading="gouraud",
        cmap=colour_map,
        vmin=colours[0],
        vmax=colours[1],
        rasterized=True,
    )
    if picture.bar is not None:
        colour_bar(drawn, picture.bar)
    return picture


def _triangulation(mesh: FittedMesh) -> Triangulation:
    from matplotlib.tri import Triangulation

    return Triangulation(mesh.points[:, 0], mesh.points[:, 1], mesh.all_simplices)
