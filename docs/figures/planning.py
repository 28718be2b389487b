"""Figures of docs/planning.md: a turning bar that meets a disk, and parts packed on a strip."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from PIL import Image

from rfm.calculus import cos, sin
from rfm.calculus.types import Array, Value
from rfm.geometry import Box, Shape, disk, rectangle
from rfm.geometry.planning import Motion, first_contact, monotone_search, moving, region

INK, FIRST, SECOND = "#222222", "#2c7fb8", "#c0392b"
RADII, HEIGHT = (0.5, 0.35, 0.42), 1.4


def crane() -> tuple[Shape, Motion, Shape, Motion, Box]:
    """A turning bar and a disk on its way; the time runs from 0 to 2."""
    bar, load = rectangle(min=(0.0, -0.12), max=(1.6, 0.12)), disk(center=(0, 0), radius=0.25)
    turn = Motion(lambda t: (0.0 * t, 0.0 * t), lambda t: 0.9 * t)
    travel = Motion(lambda t: (1.7 - 0.35 * t, 1.3 - 0.3 * t))
    return bar, turn, load, travel, Box((-2, -2, 0), (2, 2, 2))


def packing() -> Array:
    """Centres of three disks on a strip of given height that needs the least length, and this length."""
    count = len(RADII)

    def gap(*v: Value, i: int, j: int) -> Value:
        square = (v[2 * i] - v[2 * j]) ** 2 + (v[2 * i + 1] - v[2 * j + 1]) ** 2
        return square - (RADII[i] + RADII[j]) ** 2

    def side(*v: Value, i: int, which: int) -> Value:
        x, y, r = v[2 * i], v[2 * i + 1], RADII[i]
        return (x - r, v[-1] - x - r, y - r, HEIGHT - y - r)[which]

    constraints = [partial(side, i=i, which=k) for i in range(count) for k in range(4)]
    constraints += [partial(gap, i=i, j=j) for i in range(count) for j in range(i)]
    box = Box((0,) * (2 * count + 1), (3, HEIGHT) * count + (3,))
    starts = np.array(
        [
            [value for place in order for value in (0.55 + 0.9 * place, 0.6 + 0.15 * place)] + [2.9]
            for order in ((0, 1, 2), (1, 0, 2), (0, 2, 1))
        ]
    )
    return monotone_search(region(constraints), lambda *v: 0.0 * v[0] - v[-1], box, starts=starts).point


def render(folder: Path) -> None:
    """Write planning.png."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.6, 4.2), dpi=100)
    _crane(left)
    _packing(right)
    figure.tight_layout()
    target = folder / "planning.png"
    figure.savefig(target)
    plt.close(figure)
    with Image.open(target) as picture:
        small = picture.convert("RGB").resize((720, 315), Image.Resampling.LANCZOS)
    small.quantize(96, dither=Image.Dither.NONE).save(target, optimize=True)


def _crane(axes: plt.Axes) -> None:
    bar, turn, load, travel, box = crane()
    first, second = moving(bar, turn), moving(load, travel)
    clash = first_contact(first, second, box)
    x, y = np.meshgrid(np.linspace(-0.6, 2.1, 500), np.linspace(-0.4, 1.9, 430))
    last = clash.time if clash else 2.0
    for share, alpha in ((0.0, 0.25), (0.5, 0.5), (1.0, 1.0)):
        for field, colour in ((first, FIRST), (second, SECOND)):
            axes.contour(x, y, field(x, y, share * last + 0.0 * x), [0.0], colors=colour, alpha=alpha)
    if clash:
        axes.plot(*clash.point, "o", color=INK, markersize=5)
        axes.set_title(f"first contact at t = {clash.time:.4f}", fontsize=10)
    axes.set_aspect("equal")


def _packing(axes: plt.Axes) -> None:
    found = packing()
    turns = np.linspace(0, 2 * np.pi, 100)
    circle: Callable[[float, float, float], tuple[Array, Array]] = lambda a, b, r: (  # noqa: E731
        a + r * np.asarray(cos(turns)),
        b + r * np.asarray(sin(turns)),
    )
    for i, radius in enumerate(RADII):
        axes.fill(*circle(found[2 * i], found[2 * i + 1], radius), color=FIRST, alpha=0.35)
        axes.plot(*circle(found[2 * i], found[2 * i + 1], radius), color=FIRST)
    length = found[-1]
    axes.plot([0, length, length, 0, 0], [0, 0, HEIGHT, HEIGHT, 0], color=INK)
    axes.set_title(f"three disks on a strip of height {HEIGHT}: length {length:.4f}", fontsize=10)
    axes.set_aspect("equal")
