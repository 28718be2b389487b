"""Pictures of blends and transformations: the pawn, the wheel of example 6.1, blends, a few maps of solids."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

import rfm.geometry as g
from rfm.app.pictures.canvas import FAINT, INK, new_figure, png_bytes
from rfm.calculus import partials
from rfm.geometry.blending import blend, bounded_blend, displacement_blend, shell
from rfm.geometry.blending.operands import function_of
from rfm.geometry.transforms import (
    affine,
    cyclic,
    extrude,
    repeat,
    revolve,
    screw,
    section,
    sweep,
    taper,
    twist,
)

FILL, LINE, OTHER = "#cfe3f1", "#14618f", "#b3263e"


def pawn() -> g.Shape:
    """The pawn of figures 4.1 and 6.10: a turned body with rings, a collar and a head."""
    r, ring = g.rectangle, lambda x, y, d: g.disk((x, y), d)
    foot = r((0, 0), (1.0, 0.25)) | ring(1.0, 0.125, 0.125) | r((0, 0.25), (0.8, 0.4)) | ring(0.8, 0.4, 0.1)
    body = g.polygon([(0, 0.4), (0.75, 0.4), (0.3, 1.7), (0, 1.7)]) - g.ellipse((0.9, 1.3), (0.52, 0.8), 0.2)
    collar = g.ellipse((0, 1.75), (0.55, 0.1)) & r((0, 1), (1, 2)) | ring(0.3, 1.62, 0.08)
    return revolve(foot | body | collar | g.disk((0, 2.1), 0.42))


def wheel(by: str = "wave", terms: int = 8) -> g.Shape:
    """The wheel of example 6.1: rim, hub and spokes, of which one is written down."""
    spoke = g.rectangle((0.1, -0.06), (0.9, 0.06))
    rim = g.disk((0, 0), 1.0) - g.disk((0, 0), 0.82)
    hub = g.disk((0, 0), 0.28) - g.disk((0, 0), 0.12)
    window = g.disk((0, 0), 0.9) - g.disk((0, 0), 0.2)
    return rim | hub | (cyclic(spoke, 8, by=by, terms=terms) & window)


def flag() -> g.Shape:
    """The region of the flag of figure 4.4: a waving cloth beside its pole."""
    cloth = g.function(
        lambda x, y: 0.35**2 - (y - 1.4 - 0.1 * np.pi * x * (1 - x)) ** 2,
        box=((0.0, 0.9), (1.5, 2.0)),
        size=0.35,
    )
    return cloth & g.rectangle((0.05, 0.0), (1.3, 3.0)) | g.rectangle((-0.05, 0.0), (0.05, 2.0))


def render(folder: Path) -> None:
    """Write the pictures."""
    _save(_wheels(), folder / "wheel.png")
    _save(_blends(), folder / "blends.png")
    _save(_pawn(), folder / "pawn.png")
    _save(_flag(), folder / "flag.png")
    _save(_maps(), folder / "transforms.png")


def _save(figure: Any, path: Path) -> None:
    path.write_bytes(png_bytes(figure))
    with Image.open(path) as image:
        small = image.convert("RGB")
        if small.width > 720:
            small = small.resize((720, round(small.height * 720 / small.width)), Image.Resampling.LANCZOS)
        small.quantize(96).save(path, optimize=True)


def _plane(axes: Any, box: tuple[float, float, float, float], count: int = 360) -> tuple[Any, Any]:
    x0, x1, y0, y1 = box
    axes.set_aspect("equal")
    axes.set_axis_off()
    axes.set_xlim(x0, x1)
    axes.set_ylim(y0, y1)
    return np.meshgrid(np.linspace(x0, x1, count), np.linspace(y0, y1, count))


def _levels(
    axes: Any, shape: g.Shape, box: tuple[float, float, float, float], text: str, values: Any
) -> None:
    x, y = _plane(axes, box)
    f = values(x, y)
    top = float(np.nanmax(f))
    axes.contourf(x, y, f, levels=np.linspace(-top, top, 26), cmap="RdBu_r", extend="both", alpha=0.85)
    axes.contour(x, y, f, levels=np.linspace(0.0, top, 6)[1:], colors=FAINT, linewidths=0.5)
    axes.contour(x, y, shape.membership(x, y), levels=[0.0], colors=INK, linewidths=1.1)
    axes.set_title(text, fontsize=8.5, color=INK)


def _wheels() -> Any:
    figure = new_figure((7.2, 4.9))
    box = (-1.15, 1.15, -1.15, 1.15)
    spoke = g.rectangle((0.1, -0.06), (0.9, 0.06))
    plain, series = wheel(), wheel("fourier", 6)
    unit = function_of(plain)
    panels = [
        (spoke, "one spoke", function_of(spoke)),
        (
            cyclic(spoke, 8, by="wave"),
            "folded by the triangle wave",
            function_of(cyclic(spoke, 8, by="wave")),
        ),
        (
            cyclic(spoke, 8, by="fourier", terms=3),
            "Fourier series, 3 terms",
            function_of(cyclic(spoke, 8, by="fourier", terms=3)),
        ),
        (plain, "the wheel, minimum and maximum", plain.membership),
        (plain, "its R0-function, unit slope", unit),
        (series, "R0-function with 6 terms", function_of(series)),
    ]
    for i, (shape, text, values) in enumerate(panels):
        axes = figure.add_axes((0.01 + (i % 3) * 0.33, 0.5 - (i // 3) * 0.49, 0.32, 0.44))
        _levels(axes, shape, box, text, values)
    return figure


def _flag() -> Any:
    figure = new_figure((7.2, 3.4))
    region = flag()
    for i, (text, values) in enumerate(
        (("minimum and maximum", region.membership), ("R0-function of unit slope", function_of(region)))
    ):
        axes = figure.add_axes((0.08 + 0.45 * i, 0.02, 0.4, 0.88))
        _levels(axes, region, (-0.35, 1.65, -0.2, 2.2), text, values)
    return figure


def _blends() -> Any:
    figure = new_figure((7.2, 1.95))
    a, b = g.disk((0, 0), 1.0), g.disk((1.5, 0.2), 0.8)
    within = g.disk((0.9, 0.85), 0.45)
    panels = [
        (blend([a, b], 0.35), "rho-blend, radius 0.35"),
        (displacement_blend([a, b], 0.2), "displacement, a0 = 0.2"),
        (bounded_blend([a, b], within, 0.3, (0.4, 0.4, 0.3)), "bounded blend"),
        (blend([a, ~b], 0.25, "intersection"), "difference, rounded"),
    ]
    for i, (shape, text) in enumerate(panels):
        axes = figure.add_axes((0.005 + i * 0.25, 0.02, 0.24, 0.84))
        x, y = _plane(axes, (-1.15, 2.45, -1.15, 1.35))
        axes.contourf(x, y, shape.membership(x, y), levels=[0.0, 1e9], colors=[FILL])
        for plain in (a, b, *([within] if "bounded" in text else [])):
            dashes = ":" if plain is within else "--"
            axes.contour(
                x, y, plain.membership(x, y), levels=[0.0], colors=FAINT, linewidths=0.8, linestyles=dashes
            )
        axes.contour(x, y, shape.membership(x, y), levels=[0.0], colors=LINE, linewidths=1.4)
        axes.set_title(text, fontsize=8.5, color=INK)
    return figure


def _pawn() -> Any:
    figure = new_figure((7.2, 4.0))
    solid = pawn()
    axes = figure.add_axes((0.0, 0.02, 0.36, 0.96))
    axes.imshow(_picture(solid, 420, (0.0, 0.0, 1.2), 1.5), interpolation="bilinear")
    axes.set_axis_off()
    cut = section(solid, (0, 0, 0), (0, 1, 0))
    box = (-1.25, 1.25, -0.12, 2.68)
    for k, (text, values) in enumerate(
        (("minimum and maximum", None), ("R0-function of unit slope", function_of(cut)))
    ):
        axes = figure.add_axes((0.36 + 0.325 * k, 0.02, 0.31, 0.88))
        x, y = _plane(axes, box)
        f = (lambda x, y: cut.membership(y, x)) if values is None else (lambda x, y, v=values: v(y, x))
        inside = cut.membership(y, x)
        v = f(x, y)
        top = float(v.max())
        axes.contourf(x, y, v, levels=np.linspace(-top, top, 26), cmap="RdBu_r", extend="both", alpha=0.85)
        axes.contour(x, y, v, levels=np.linspace(0.0, top, 6)[1:], colors=FAINT, linewidths=0.5)
        axes.contour(x, y, inside, levels=[0.0], colors=INK, linewidths=1.1)
        axes.set_title(text, fontsize=8.5, color=INK)
    return figure


def _maps() -> Any:
    figure = new_figure((7.2, 3.6))
    bar = g.box((-0.4, -0.4, -1), (0.4, 0.4, 1))
    gear = cyclic(g.disk((0.7, 0), 0.25), 6) | g.disk((0, 0), 0.7)
    tube = g.disk((0.75, 0), 0.22)
    solids = [
        ("extrude, slanted", extrude(gear.scale(0.8), (0.5, 0.2, 1.4)).move((-0.2, 0, -0.7))),
        ("twist", twist(bar, 1.2)),
        ("taper", taper(bar, -1.0, 1.0, 0.4)),
        ("screw", screw(g.disk((0.35, 0), 0.4).move((0, 0)), 1.6, 2.0).move((0, 0, -1))),
        (
            "revolve",
            revolve(g.polygon([(0.4, -0.7), (1.0, -0.2), (0.7, 0.7)])),
        ),
        (
            "affine",
            affine(g.torus((0, 0, 0), (0, 0, 1), 0.7, 0.25), [[1, 0.3, 0], [0, 0.7, 0], [0.2, 0, 1.5]]),
        ),
        ("repeat", repeat(g.torus((0, 0, 0), (0, 0, 1), 0.55, 0.14), (0, 0, 0.5), 4).move((0, 0, -0.75))),
        ("sweep", sweep(g.ball((0.8, 0, -0.7), 0.28), (0, 0, 1.4), 4.2, (0, 0, 1), samples=24)),
        (
            "blend",
            blend([g.ball((0, 0, 0), 0.7), g.cylinder((0, 0, 0), (0, 0, 1), 0.3, 2.0), revolve(tube)], 0.2),
        ),
        (
            "shell, cut open",
            shell(g.ball((0, 0, 0), 1.0), 0.15) - g.half_space((0, 0, 0), (0.49, -0.79, 0.37)),
        ),
    ]
    for i, (text, solid) in enumerate(solids):
        axes = figure.add_axes((0.005 + (i % 5) * 0.199, 0.5 - (i // 5) * 0.49, 0.19, 0.42))
        axes.imshow(_picture(solid, 230, (0, 0, 0), 1.3), interpolation="bilinear")
        axes.set_axis_off()
        axes.set_title(text, fontsize=8.5, color=INK)
    return figure


def _picture(solid: g.Shape, pixels: int, centre: tuple[float, float, float], half: float) -> Any:
    """Shaded picture of a solid by marching along parallel rays to the first change of sign."""
    a, e = np.radians([-58.0, 22.0])
    right = np.array([-np.sin(a), np.cos(a), 0.0])
    toward = np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
    up = np.cross(toward, right)
    u, v = np.meshgrid(np.linspace(-half, half, pixels), np.linspace(half, -half, pixels))
    base = np.array(centre) + u.reshape(-1, 1) * right + v.reshape(-1, 1) * up
    steps = np.linspace(2.2 * half, -2.2 * half, 400)
    hit = np.full(len(base), np.nan)
    open_ = np.arange(len(base))
    for far, near in zip(steps[1:], steps[:-1], strict=True):
        inside = solid.membership(*(base[open_] + far * toward).T) > 0.0
        found = open_[inside]
        low, high = np.full(len(found), far), np.full(len(found), near)
        for _ in range(14):
            middle = 0.5 * (low + high)
            within = solid.membership(*(base[found] + middle[:, None] * toward).T) > 0.0
            low, high = np.where(within, middle, low), np.where(within, high, middle)
        hit[found] = high
        open_ = open_[~inside]
    image = np.ones((len(base), 3))
    seen = np.flatnonzero(np.isfinite(hit))
    points = base[seen] + hit[seen, None] * toward
    slope = partials(solid.membership, tuple(points.T), 1)[1:].T
    normal = -slope / np.maximum(np.linalg.norm(slope, axis=1, keepdims=True), 1e-12)
    light = np.array([0.35, -0.5, 0.8]) / np.linalg.norm([0.35, -0.5, 0.8])
    shade = 0.35 + 0.65 * np.clip(normal @ light, 0.0, 1.0)
    image[seen] = np.clip(shade[:, None] * np.array([0.66, 0.79, 0.9]) * 1.1, 0.0, 1.0)
    return image.reshape(pixels, pixels, 3)
