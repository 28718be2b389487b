"""Figures of docs/spline-r-functions.md: the six groups of ordinates, errors with the functions as weights."""

from __future__ import annotations

import runpy
from collections.abc import Callable
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from PIL import Image

from rfm.calculus import spline_system
from rfm.geometry import disk
from solvers import ritz
from solvers.norms import error_norms
from solvers.problem import Discretization, Problem

BENCHMARK = Path(__file__).resolve().parents[2] / "benchmarks" / "spline_weights.py"
INK = "#222222"


def render(folder: Path) -> None:
    """Write spline_groups.png and spline_errors.png."""
    _save(_groups(), folder / "spline_groups.png")
    _save(_errors(runpy.run_path(str(BENCHMARK))["problem_of"]), folder / "spline_errors.png")


def _groups() -> plt.Figure:
    """Conjunctions of bidegree 2 and 3, one column for each group."""
    figure, axes = plt.subplots(2, 6, figsize=(12.0, 4.4), dpi=100, sharex=True, sharey=True)
    x, y = np.meshgrid(np.linspace(-1, 1, 301), np.linspace(-1, 1, 301))
    for k, row in zip((2, 3), axes, strict=True):
        for group, ax in enumerate(row, 1):
            r = spline_system(k, group).conjunction(x, y)
            ax.contourf(x, y, r, levels=np.linspace(-1, 1, 21), cmap="RdBu", alpha=0.7)
            ax.contour(x, y, r, levels=np.linspace(-0.9, 0.9, 10), colors=INK, linewidths=0.4)
            ax.plot([0, 0, 1], [1, 0, 0], color=INK, lw=1.8)
            ax.set_aspect("equal")
            ax.set_title(f"k = {k}, group {group}", fontsize=13)
            ax.set_xticks([-1, 0, 1])
            ax.set_yticks([-1, 0, 1])
    figure.tight_layout()
    return figure


def _errors(problem_of: Callable[..., Problem]) -> plt.Figure:
    """Relative L2 errors on the lens and the union of two disks."""
    figure, axes = plt.subplots(1, 2, figsize=(11.0, 4.6), dpi=100, sharey=True)
    one, other = disk((0, 0), 1.0), disk((0.8, 0), 1.0)
    spacings = 0.5 ** np.arange(1, 6)
    for ax, (name, domain) in zip(
        axes, {"intersection": one & other, "union": one | other}.items(), strict=True
    ):
        for k, color in zip((1, 2, 3), ("tab:blue", "tab:orange", "tab:green"), strict=True):
            for weight, style in ((f"spline{k}", "o-"), ("r0", "s--")):
                problem = problem_of(domain, weight)
                errors = []
                for h in spacings:
                    how = Discretization(degree=k, spacing=float(h), weight=weight)
                    solution = ritz.solve(problem, how)
                    errors.append(error_norms(solution.trial, problem.exact, solution.background).l2)
                ax.loglog(spacings, errors, style, color=color, ms=5, lw=1.4, label=weight)
            slope = errors[-1] * 0.4 * (spacings / spacings[-1]) ** (k + 1)
            ax.loglog(spacings, slope, ":", color="0.5", lw=1)
            ax.text(spacings[-2], slope[-2] * 0.2, f"$h^{k + 1}$", fontsize=13, color="0.35")
        ax.set_title(f"two disks, {name}: relative error in $L_2$", fontsize=14)
        ax.set_xlabel("h", fontsize=13)
        ax.set_xticks(spacings, [f"1/{round(1 / h)}" for h in spacings])
        ax.minorticks_off()
        ax.grid(True, which="major", alpha=0.3)
    axes[1].legend(fontsize=11, ncols=2, loc="lower right")
    figure.tight_layout()
    return figure


def _save(figure: plt.Figure, target: Path) -> None:
    figure.savefig(target)
    plt.close(figure)
    with Image.open(target) as picture:
        height = round(720 * picture.height / picture.width)
        small = picture.convert("RGB").resize((720, height), Image.Resampling.LANCZOS)
    small.quantize(128, dither=Image.Dither.NONE).save(target, optimize=True)
