"""Figures of docs/functional-voxels.md: M-images of a circle, zero sets of circle, cylinder and slab."""

from __future__ import annotations

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from PIL import Image

from rfm.calculus.types import Value
from rfm.geometry import Box
from rfm.geometry.voxels import VoxelModel, read_images, voxels, write_images, zero_points

SQUARE = Box((-1.5, -1.5), (1.5, 1.5))
CUBE = Box((-1, -1, -1), (1, 1, 1))


def circle(x: Value, y: Value) -> Value:
    """Positive inside the unit circle."""
    return 1 - x * x - y * y


def tube(x: Value, y: Value, z: Value) -> Value:
    """Positive inside a cylinder about the z axis."""
    return 0.5 - x * x - y * y + 0.0 * z


def layer(x: Value, y: Value, z: Value) -> Value:
    """Positive inside a slab."""
    return 0.16 - (0.6 * x + 0.8 * z) ** 2 + 0.0 * y


def render(folder: Path) -> None:
    """Write functional_voxels.png."""
    figure = plt.figure(figsize=(10.0, 5.2), dpi=100)
    with tempfile.TemporaryDirectory() as scratch:
        model = voxels(circle, SQUARE, (160, 160))
        for row, kind in enumerate(("grey", "rgb")):
            for i, path in enumerate(write_images(model, scratch, kind, kind)[: 4 if kind == "grey" else 1]):
                axes = figure.add_subplot(2, 4, 4 * row + i + 1)
                with Image.open(path) as picture:
                    axes.imshow(np.asarray(picture), cmap="gray", vmin=0, vmax=255)
                axes.set_title(f"$M_{i + 1}$, {'8' if kind == 'grey' else '24'} bits", fontsize=10)
                axes.set_axis_off()
        small = voxels(circle, SQUARE, (24, 24))
        write_images(small, scratch, "small")
        _zero_curve(figure.add_subplot(2, 4, 6), read_images(scratch, "small"))
    for place, (field, title) in enumerate(((tube, "cylinder"), (layer, "slab"))):
        axes = figure.add_subplot(2, 4, 7 + place, projection="3d")
        points, _ = zero_points(voxels(field, CUBE, (25, 25, 25)))
        axes.scatter(*points.T, s=1.5, c=points[:, 1], cmap="viridis")
        axes.set_title(f"{title}, 25³ voxels", fontsize=10)
        axes.set_box_aspect((1, 1, 1))
        axes.set_xticks([])
        axes.set_yticks([])
        axes.set_zticks([])
    figure.tight_layout()
    target = folder / "functional_voxels.png"
    figure.savefig(target)
    plt.close(figure)
    with Image.open(target) as picture:
        reduced = picture.convert("RGB").resize((720, 374), Image.Resampling.LANCZOS)
    reduced.quantize(160, dither=Image.Dither.NONE).save(target, optimize=True)


def _zero_curve(axes: plt.Axes, model: VoxelModel) -> None:
    """Voxels that the circle passes, and the piece of its plane's zero line in each."""
    points, normals = zero_points(model)
    tangents = np.stack([-normals[:, 1], normals[:, 0]], axis=1) * 0.5 * model.spacing.max()
    for point, tangent in zip(points, tangents, strict=True):
        axes.plot(*np.stack([point - tangent, point + tangent], axis=1), color="#c0392b", linewidth=1.6)
    axes.plot(*points.T, ".", color="#222222", markersize=2)
    axes.set_aspect("equal")
    axes.set_title("read back, 24² voxels", fontsize=10)
    axes.set_xticks([])
    axes.set_yticks([])
