"""Figures of docs/normalisation.md: level lines of an ellipse's function by order, and the forms of a weight."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from PIL import Image

import rfm.geometry as g
from rfm.geometry.weight_forms import Plateau, Scaled

OVAL = g.ellipse((0, 0), (1.0, 0.45))
LEVELS = np.arange(-0.4, 0.41, 0.1)


def render(folder: Path) -> None:
    """Write normalisation.png."""
    x, y = np.meshgrid(np.linspace(-1.5, 1.5, 401), np.linspace(-0.95, 0.95, 261))
    figure, axes = plt.subplots(2, 2, figsize=(8.6, 5.2), layout="constrained")
    f = OVAL.surfaces[0].function
    fields = {"f, a quadric": f} | {f"normalised to order {m}": g.normalise(f, 2, m) for m in (1, 3)}
    for panel, (title, field) in zip(axes.flat, fields.items(), strict=False):
        values = field(x, y)
        panel.contour(x, y, values, levels=LEVELS, colors="#7c93ad", linewidths=0.8)
        panel.contour(x, y, values, levels=[0.0], colors="#12263f", linewidths=1.6)
        panel.set(xticks=[], yticks=[], aspect="equal", title=f"{title}: levels 0.1 apart")
        panel.title.set_fontsize(9)
    profile(axes[1, 1])
    file = folder / "normalisation.png"
    figure.savefig(file, dpi=83)
    plt.close(figure)
    Image.open(file).convert("RGB").quantize(64).save(file, optimize=True)


def profile(panel: plt.Axes) -> None:
    """Draw the forms as functions of the distance."""
    t = np.linspace(-0.05, 1.0, 400)
    for beta, alpha, style in ((3.0, 2.0, "-"), (3.0, 1.0, "--")):
        w = Scaled(lambda s: s, beta, alpha)
        panel.plot(t, w(t), style, color="#b3541e", lw=1.3, label=f"scaled, beta = 3, alpha = {alpha:g}")
    for gamma, style in ((1, ":"), (2, "--"), (3, "-")):
        w = Plateau(lambda s: s, 0.4, gamma)
        panel.plot(t, w(t), style, color="#1f5fa8", lw=1.3, label=f"plateau, delta = 0.4, gamma = {gamma}")
    panel.axhline(0.0, color="#12263f", lw=0.7)
    panel.axvline(0.0, color="#12263f", lw=0.7)
    panel.set(ylim=(-0.2, 1.1), xlabel="distance", title="forms of a weight")
    panel.title.set_fontsize(9)
    panel.legend(fontsize=7, frameon=False, loc="center right", bbox_to_anchor=(1.0, 0.6))
    panel.tick_params(labelsize=7)
