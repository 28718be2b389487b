"""Figure of docs/boundary-functions.md: functions of pieces of boundary, one by one, joined, signed, and mixed."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from PIL import Image

from rfm.calculus.types import Array, Field
from rfm.geometry import rectangle
from rfm.geometry.boundaries import (
    arc,
    bezier,
    mixed_set,
    polyline,
    segment,
    signed,
    signed_surface,
    spline,
    surface,
)

INK = "#222222"
STAR = 2 * np.pi * np.arange(9) / 9


def torus_faces(across: int = 24, around: int = 12) -> tuple[Array, Array]:
    """Vertices and triangles of a ring."""
    u, v = np.meshgrid(np.arange(across), np.arange(around), indexing="ij")
    big, small = 2 * np.pi * u / across, 2 * np.pi * v / around
    radius = 0.72 + 0.3 * np.cos(small)
    points = np.stack([radius * np.cos(big), radius * np.sin(big), 0.3 * np.sin(small)], axis=-1)

    def number(i: Array, j: Array) -> Array:
        return (i % across) * around + j % around

    a, b, c, d = number(u, v), number(u + 1, v), number(u + 1, v + 1), number(u, v + 1)
    faces = np.stack([np.stack([a, b, c], axis=-1), np.stack([a, c, d], axis=-1)])
    return points.reshape(-1, 3), faces.reshape(-1, 3)


def panels() -> list[tuple[str, Field, tuple[float, float, float, float]]]:
    """Title, field of the plane, and range of each panel."""
    loop = (1.0 + 0.35 * np.cos(3 * STAR))[:, None] * np.stack([np.cos(STAR), np.sin(STAR)], axis=1)
    blob = signed(spline(np.concatenate([loop, loop[:3]]), 3, np.arange(16.0), p=4))
    flag = mixed_set([rectangle(min=(0, 0.4), max=(1, 1))], segment((0, -0.9), (0, 0.4)))
    ring = signed_surface(surface(*torus_faces(), p=8))
    return [
        (
            "segment and arc, joined",
            segment((-1, -0.5), (0.5, 0.8)) | arc((0.3, -0.2), 0.6, -2.6, 0.4),
            (-1.3, 1.3, -1.1, 1.1),
        ),
        (
            "polyline",
            polyline([(-1, -0.7), (-0.3, 0.7), (0.1, -0.5), (0.6, 0.5), (1, 0.3)]),
            (-1.3, 1.3, -1.1, 1.1),
        ),
        (
            "cubic Bézier curve with a loop",
            bezier([(-0.9, -0.8), (2.1, 1.2), (-2.1, 1.2), (0.9, -0.8)]),
            (-1.3, 1.3, -1.1, 1.1),
        ),
        ("closed cubic B-spline, signed", blob, (-1.5, 1.5, -1.27, 1.27)),
        ("flag with its handle", flag, (-0.9, 1.7, -1.1, 1.1)),
        (
            "ring of 576 triangles, slice z = 0.1",
            lambda x, y: ring(x, y, np.full_like(x, 0.1)),
            (-1.3, 1.3, -1.1, 1.1),
        ),
    ]


def render(folder: Path) -> None:
    """Write boundary_functions.png."""
    figure, grid = plt.subplots(2, 3, figsize=(9.6, 5.9), dpi=100)
    for axes, (title, field, limits) in zip(grid.flat, panels(), strict=True):
        _draw(axes, field, limits)
        axes.set_title(title, fontsize=10)
    figure.tight_layout()
    target = folder / "boundary_functions.png"
    figure.savefig(target)
    plt.close(figure)
    with Image.open(target) as picture:
        small = picture.convert("RGB").resize((720, 442), Image.Resampling.LANCZOS)
    small.quantize(96, dither=Image.Dither.NONE).save(target, optimize=True)


def _draw(axes: plt.Axes, field: Field, limits: tuple[float, float, float, float]) -> None:
    x, y = np.meshgrid(np.linspace(*limits[:2], 241), np.linspace(*limits[2:], 205))
    value = field(x, y)
    top = float(np.abs(value).max())
    has_sign = value.min() < 0.0
    steps = np.linspace(-top if has_sign else 0.0, top, 33 if has_sign else 17)
    axes.contourf(x, y, value, levels=steps, cmap="RdBu" if has_sign else "Blues_r", alpha=0.7)
    axes.contour(x, y, value, levels=steps, colors=INK, linewidths=0.35, alpha=0.6, linestyles="solid")
    # a curve on which the sign does not change is drawn by a level close to zero
    axes.contourf(x, y, np.abs(value), levels=[0.0, 0.014], colors=INK)
    axes.set_aspect("equal")
    axes.set_xticks([])
    axes.set_yticks([])
