"""Pictures of docs/outlines.md: a polygon and its chains, outlines with their chords, polyhedra."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from PIL import Image

import rfm.geometry as g
from rfm.geometry.outlines.chains import Chain, tree_of_chains

DPI = 100
RANDOM_STEPS = 26
CUBE = [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2)]
SIDES = [[0, 1, 2, 3], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]


def render(folder: Path) -> None:
    """Write the pictures."""
    _polygon(folder / "outlines_polygon.png")
    _arcs(folder / "outlines_arcs.png")
    _polyhedra(folder / "outlines_polyhedra.png")


def _polygon(path: Path) -> None:
    vertices = _star()
    figure, (left, right) = plt.subplots(1, 2, figsize=(7.2, 3.5), layout="constrained")
    levels = _levels(tree_of_chains(vertices), len(vertices))
    closed = np.vstack([vertices, vertices[:1]])
    colours = plt.get_cmap("viridis")(np.array(levels) / max(levels))
    for a, b, colour in zip(closed[:-1], closed[1:], colours, strict=True):
        left.plot([a[0], b[0]], [a[1], b[1]], color=colour, linewidth=2.2)
    left.plot(*vertices.T, ".", color="black", markersize=4)
    left.set_title(f"{len(vertices)} edges; colour: changes between & and |", fontsize=9)
    x, y, values = _values(g.polygon(vertices).using("r0"), margin=0.5)
    limit = float(np.quantile(np.abs(values), 0.9))
    right.contourf(x, y, values, levels=np.linspace(-limit, limit, 15), cmap="RdBu_r", extend="both")
    right.contour(x, y, values, levels=[0.0], colors="black", linewidths=1.0)
    right.set_title("its R0-function", fontsize=9)
    _finish(figure, (left, right), path)


def _arcs(path: Path) -> None:
    ring = [(np.cos(t), np.sin(t)) for t in np.arange(6) * np.pi / 3]
    bar = [(0, 0), (0.75, 0), (1.25, 0), (2, 0), (2, 1), (1.25, 1), (0.75, 1), (0, 1)]
    shapes = {
        "notched bar": g.outline(bar, {1: {"radius": -0.25}, 3: {"through": (2.1, 0.5)}, 5: {"bulge": -1}}),
        "slot": g.outline([(0, 0), (2, 0), (2, 1), (0, 1)], {1: {"bulge": 1}, 3: {"bulge": 1}}),
        "flower": g.outline(ring, {k: {"bulge": 1.2} for k in range(6)}),
        "gear": g.outline(ring, {k: {"bulge": -0.3} for k in range(0, 6, 2)}),
    }
    figure, axes = plt.subplots(1, 4, figsize=(7.2, 2.5), layout="constrained")
    for ax, (name, shape) in zip(axes, shapes.items(), strict=True):
        x, y, values = _values(shape, margin=0.25, count=300)
        ax.contourf(x, y, values, levels=[0.0, np.inf], colors=["#cfe0f3"])
        ax.contour(x, y, values, levels=[0.0], colors="black", linewidths=1.2)
        chords = [surface for surface in shape.surfaces if surface.auxiliary]
        for chord in chords:
            line = np.broadcast_to(chord.function(x, y), x.shape)
            ax.contour(x, y, line, levels=[0.0], colors="tab:red", linewidths=0.8, linestyles="dashed")
        ax.set_title(
            f"{name}: {len(shape.expression.literals())} literals,\n{len(chords)} chords", fontsize=8
        )
    _finish(figure, axes, path)


def _polyhedra(path: Path) -> None:
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    roof = [[4, 5, 8], [5, 6, 8], [6, 7, 8], [7, 4, 8]]
    corner = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]
    prism = [(x, y, z) for z in (0, 1.2) for x, y in corner]
    walls = [[i, (i + 1) % 6, 6 + (i + 1) % 6, 6 + i] for i in range(6)]
    turns = 2 * np.pi * np.arange(3) / 3
    twisted = [(np.cos(t + s), np.sin(t + s), 2.0 * (s > 0)) for s in (0.0, 0.5) for t in turns]
    lower = [[i, (i + 1) % 3, 3 + (i + 1) % 3] for i in range(3)]
    upper = [[i, 3 + (i + 1) % 3, 3 + i] for i in range(3)]
    solids: list[tuple[str, Any, list[list[int]]]] = [
        ("dented cube", [*CUBE, (1, 1, 0.8)], [*SIDES, *roof]),
        ("prism over an L", prism, [list(range(6)), list(range(6, 12)), *walls]),
        ("twisted prism", twisted, [[0, 1, 2], [3, 4, 5], *lower, *upper]),
    ]
    figure = plt.figure(figsize=(7.2, 2.9), layout="constrained")
    for number, (name, vertices, faces) in enumerate(solids):
        shape = g.polyhedron(vertices, faces)
        ax: Any = figure.add_subplot(1, 3, number + 1, projection="3d")
        points = np.array(vertices, dtype=float)
        chains = [points[face] for face in faces]
        ax.add_collection3d(
            Poly3DCollection(chains, facecolor="#9fc0e6", edgecolor="black", linewidths=0.8, alpha=0.55)
        )
        low, high = points.min(axis=0), points.max(axis=0)
        ax.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
        ax.set_box_aspect(high - low, zoom=0.85)
        ax.view_init(32, -58)
        ax.set_axis_off()
        words = f"{len(shape.surfaces)} planes, {len(shape.expression.literals())} literals"
        ax.set_title(f"{name}\n{words}", fontsize=8, y=0.99)
    figure.savefig(path, dpi=DPI)
    plt.close(figure)
    _quantise(path)


def _star() -> np.ndarray:
    """Return a spiky polygon with pockets in pockets."""
    random = np.random.default_rng(8)
    angles = (np.arange(RANDOM_STEPS) + random.uniform(0.1, 0.9, RANDOM_STEPS)) * 2 * np.pi / RANDOM_STEPS
    radii = random.uniform(0.25, 1.0, RANDOM_STEPS)
    return np.stack([1.4 * radii * np.cos(angles), radii * np.sin(angles)], axis=1)


def _levels(tree: Chain, count: int) -> list[int]:
    """For every edge, how often & and | alternate above it."""
    levels = [0] * count

    def descend(node: Chain, left: bool, level: int) -> None:
        if not node.halves:
            levels[node.first % count] = level
            return
        level += int(node.left != left)
        for half in node.halves:
            descend(half, node.left, level)

    descend(tree, True, 0)
    return levels


def _values(shape: g.Shape, margin: float, count: int = 220) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    box = shape.box.padded(margin)
    axes = [np.linspace(low, high, count) for low, high in zip(box.lower, box.upper, strict=True)]
    x, y = np.meshgrid(*axes)
    values = g.sample(shape, np.stack([x.ravel(), y.ravel()], axis=1), order=0)[0]
    return x, y, values.reshape(x.shape)


def _finish(figure: Any, axes: Any, path: Path) -> None:
    for ax in axes:
        ax.set_aspect("equal")
        ax.set_axis_off()
    figure.savefig(path, dpi=DPI)
    plt.close(figure)
    _quantise(path)


def _quantise(path: Path) -> None:
    Image.open(path).convert("RGB").quantize(colors=96).save(path, optimize=True)
