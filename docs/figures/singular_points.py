"""Figures of docs/singular-points.md: corners of a plane shape on its R-function, edges of a solid."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from PIL import Image

from rfm.calculus import R0
from rfm.geometry import Shape, ball, box, cylinder, disk, ellipse, rectangle
from rfm.geometry.singular.corners import corners
from rfm.geometry.singular.edges import edges

INK, MARK = "#222222", "#c0392b"


def plane_shape() -> Shape:
    """An ellipse with a bar across, minus a disk."""
    bar = rectangle(min=(-0.2, -0.9), max=(0.25, 0.9))
    return (ellipse(center=(0, 0), semi_axes=(1, 0.55)) | bar) - disk(center=(0.62, 0.1), radius=0.22)


def solid() -> Shape:
    """A box with a corner taken out by a ball and a bore."""
    block = box(min=(0, 0, 0), max=(1, 1, 1)) - ball(center=(1, 1, 1), radius=0.55)
    return block - cylinder(center=(0.35, 0.35, 0.5), axis=(0, 0, 1), radius=0.18)


def render(folder: Path) -> None:
    """Write singular_points.png."""
    figure = plt.figure(figsize=(9.6, 4.2), dpi=100)
    _plane(figure.add_subplot(1, 2, 1))
    _space(figure.add_subplot(1, 2, 2, projection="3d"))
    figure.tight_layout()
    target = folder / "singular_points.png"
    figure.savefig(target)
    plt.close(figure)
    with Image.open(target) as picture:
        small = picture.convert("RGB").resize((720, 315), Image.Resampling.LANCZOS)
    small.quantize(128, dither=Image.Dither.NONE).save(target, optimize=True)


def _plane(axes: plt.Axes) -> None:
    shape = plane_shape()
    x, y = np.meshgrid(np.linspace(-1.15, 1.15, 401), np.linspace(-1.05, 1.05, 367))
    value = shape.expression.fold(
        lambda surface, positive: surface.function(x, y) * (1 if positive else -1),
        lambda terms: R0.conjunction(*terms),
        lambda terms: R0.disjunction(*terms),
    )
    axes.contourf(x, y, value, levels=np.linspace(-0.6, 0.6, 25), cmap="RdBu", alpha=0.55, extend="both")
    axes.contour(x, y, value, levels=[0.0], colors=INK, linewidths=1.4)
    for corner in corners(shape):
        axes.plot(*corner.point, "o", color=MARK, markersize=5)
        axes.annotate(
            f"{np.degrees(corner.angles[0]):.0f}°",
            corner.point,
            (4, 4),
            textcoords="offset points",
            fontsize=8,
        )
    axes.set_aspect("equal")
    axes.set_title("corners and interior angles", fontsize=10)


def _space(axes: plt.Axes) -> None:
    for edge in edges(solid()):
        axes.plot(*edge.points.T, color=INK if edge.closed else MARK, linewidth=1.4)
    axes.set_box_aspect((1, 1, 1))
    axes.view_init(elev=24, azim=35)
    axes.set_title("edges of a solid (black: closed)", fontsize=10)
