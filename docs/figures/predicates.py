"""Figure of docs/predicates.md: the connectives on two shapes, as sets and as functions in two systems."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from PIL import Image

import rfm.geometry as g

DISK = g.disk((0, 0), 1)
PLATE = g.rectangle((-0.2, -0.6), (1.6, 0.75))
WINDOW = (-1.4, 2.0, -1.3, 1.3)
TITLES = {
    "a & b": DISK & PLATE,
    "a | b": DISK | PLATE,
    "a - b": DISK - PLATE,
    "a ^ b": DISK ^ PLATE,
    "implies(a, b)": DISK.implies(PLATE),
    "iff(a, b)": DISK.iff(PLATE),
}


def render(folder: Path) -> None:
    """Write predicates.png."""
    x, y = np.meshgrid(np.linspace(*WINDOW[:2], 341), np.linspace(*WINDOW[2:], 261))
    figure, axes = plt.subplots(2, 6, figsize=(9.0, 3.0), layout="constrained")
    levels = np.arange(-1.0, 1.01, 0.1)
    for row, system in enumerate(("r1", "rp4")):
        for panel, (title, shape) in zip(axes[row], TITLES.items(), strict=True):
            values = shape.using(system).membership(x, y)
            panel.contourf(x, y, values, levels=[0.0, 9.0], colors=["#cfe0f3"])
            panel.contour(x, y, values, levels=levels, colors="#7c93ad", linewidths=0.4)
            panel.contour(x, y, values, levels=[0.0], colors="#12263f", linewidths=1.3)
            panel.set(xticks=[], yticks=[], aspect="equal")
            if row == 0:
                panel.set_title(title, fontsize=9, family="monospace")
        axes[row, 0].set_ylabel({"r1": "min, max", "rp4": "$R_p$, p = 4"}[system], fontsize=9)
    file = folder / "predicates.png"
    figure.savefig(file, dpi=80)
    plt.close(figure)
    Image.open(file).convert("RGB").quantize(64).save(file, optimize=True)
