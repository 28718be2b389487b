"""Figure of docs/corner-singularities.md: errors on an L-shape with and without singular functions."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from PIL import Image

from rfm.calculus import functions as fn
from rfm.geometry import polygon
from solvers import ritz
from solvers.equations.poisson import Poisson
from solvers.norms import error_norms
from solvers.problem import Dirichlet, Discretization, Problem
from solvers.solution import Solution

INK, COLOURS = "#222222", ("#1f77b4", "#c0392b", "#2a9d5c")
GRIDS = {3: (8, 12, 16, 24), 4: (6, 8, 12, 16), 6: (6, 8, 10, 12)}


def _exact(x: object, y: object) -> object:
    angle = fn.atan2(-x - y, y - x) + 0.75 * np.pi
    return (x * x + y * y) ** (1 / 3) * fn.sin(2 / 3 * angle)


def _data(x: object, y: object) -> object:
    return _exact(x, y) * (x * x + y * y - x * x * y * y)


def solved(degree: int, grid: int, singular: str) -> Solution:
    """The harmonic function r^(2/3) sin(2 theta/3)."""
    ell = polygon(((0, 0), (1, 0), (1, 1), (-1, 1), (-1, -1), (0, -1)))
    problem = Problem(ell, Poisson(), (Dirichlet(ell.part("all"), _data),), _exact)
    return ritz.solve(problem, Discretization(degree=degree, grid=grid, singular=singular))


def render(folder: Path) -> None:
    """Write corner_singularities.png."""
    figure, axes = plt.subplots(1, 3, figsize=(11.2, 3.6), dpi=100, width_ratios=(1, 1.18, 1.35))
    for place, singular, title in (
        (axes[0], "none", "splines alone (p = 4)"),
        (axes[1], "auto", "with singular functions"),
    ):
        image = _error_map(place, solved(4, 12, singular))
        place.set_title(title, fontsize=10)
    figure.colorbar(image, ax=axes[1], label=r"$\log_{10}$ of the error")
    _convergence(axes[2])
    figure.tight_layout()
    target = folder / "corner_singularities.png"
    figure.savefig(target)
    plt.close(figure)
    with Image.open(target) as picture:
        small = picture.convert("RGB").resize((720, 231), Image.Resampling.LANCZOS)
    small.quantize(128, dither=Image.Dither.NONE).save(target, optimize=True)


def _error_map(place: plt.Axes, solution: Solution) -> object:
    line = np.linspace(-0.9975, 0.9975, 200)
    x, y = np.meshgrid(line, line)
    points = np.stack([x.ravel(), y.ravel()], axis=1)
    error = np.abs(solution.u(points) - _exact(*points.T)).reshape(x.shape)
    error[(x > 0) & (y < 0)] = np.nan
    place.set_aspect("equal")
    place.set_xticks([-1, 0, 1])
    place.set_yticks([-1, 0, 1])
    with np.errstate(divide="ignore"):
        return place.imshow(
            np.log10(error), origin="lower", extent=(-1, 1, -1, 1), vmin=-9, vmax=-2, cmap="viridis"
        )


def _convergence(place: plt.Axes) -> None:
    for colour, (degree, grids) in zip(COLOURS, GRIDS.items(), strict=True):
        for singular, style in (("none", "o--"), ("auto", "o-")):
            found = [solved(degree, n, singular) for n in grids]
            errors = [error_norms(s.trial, _exact, s.pieces[0].background).l2 for s in found]
            label = f"p = {degree}" if singular == "auto" else None
            place.loglog([s.dofs for s in found], errors, style, color=colour, markersize=4, label=label)
    place.set_xlabel("unknowns")
    place.set_ylabel("relative L2 error")
    place.set_title("dashed: splines alone", fontsize=10)
    place.set_xticks([100, 200, 400, 600], ["100", "200", "400", "600"])
    place.minorticks_off()
    place.grid(alpha=0.3)
    place.legend(loc="center right", fontsize=9)
