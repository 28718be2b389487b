"""Figure of docs/structures.md: fields of two materials and of periodic conditions, with interfaces and seam."""

from __future__ import annotations

import io
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from PIL import Image

import rfm
from rfm.calculus.types import Field

CASES = Path(__file__).resolve().parents[2] / "cases"
INK = "#222222"


def panel(axes: plt.Axes, name: str, title: str, copies: int = 1) -> None:
    """Draw the field of a case, `copies` periods side by side."""
    run = rfm.solve(CASES / f"{name}.yaml", set={"discretization.grid": 24, "expect": {}})
    if run.result is None:
        raise RuntimeError("a solved run has its result")
    problem = run.result.solution.problem
    box = problem.domain.box
    x, y = np.meshgrid(*(np.linspace(a, b, 321) for a, b in zip(box.lower, box.upper, strict=True)))
    values = np.where(
        problem.domain.membership(x, y) >= 0,
        run.u(np.stack([x.ravel(), y.ravel()], 1)).reshape(x.shape),
        np.nan,
    )
    levels = np.linspace(np.nanmin(values), np.nanmax(values), 22)
    for copy in range(copies):
        at = x + copy * (box.upper[0] - box.lower[0])
        axes.contourf(at, y, values, levels, cmap="viridis")
        axes.contour(at, y, values, levels, colors="white", linewidths=0.3)
        edges: list[Field] = [problem.domain.membership, *(i.region.membership for i in problem.inclusions)]
        for edge, width in zip(edges, (0.9, *[1.3] * len(problem.inclusions)), strict=True):
            axes.contour(at, y, edge(x, y) * np.ones_like(x), [0.0], colors=INK, linewidths=width)
    axes.set_title(title, fontsize=8, color=INK)
    axes.set_aspect("equal")
    axes.set_axis_off()


def render(folder: Path) -> None:
    """Write ``interface_periodic.png``."""
    figure, axes = plt.subplots(1, 3, figsize=(7.2, 2.4), width_ratios=[1, 1, 1.7])
    panel(axes[0], "materials/disk_in_square", "conducting disk, k = 10")
    panel(axes[1], "materials/two_rings", "two rings, value and flux jump")
    panel(axes[2], "periodic/channel", "two periods of a channel", copies=2)
    figure.tight_layout(pad=0.4)
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=100)
    plt.close(figure)
    Image.open(buffer).convert("RGB").quantize(96).save(folder / "interface_periodic.png", optimize=True)
