"""Figure of docs/structures.md: two generalised Taylor polynomials and their interpolant (after Example 7.1)."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from PIL import Image

from rfm.calculus.jets import partials
from structures.taylor_example import taylor_example


def render(folder: Path) -> None:
    """Write taylor.png."""
    example = taylor_example()
    line = np.linspace(-1, 1, 321)
    x, y = np.meshgrid(line, line)
    inside = np.asarray(example.domain.membership(x, y)) >= 0
    figure, panels = plt.subplots(1, 3, figsize=(10.8, 3.7), dpi=100)
    titles = ("$P_1$: value and slope on the hole", "$P_2$: value on the rim", "interpolant (7.12): both")
    for axes, field, title in zip(
        panels, (example.hole, example.rim, example.interpolant), titles, strict=True
    ):
        values = np.where(inside, partials(field, (x, y), 0)[0], np.nan)
        drawn = axes.contourf(x, y, values, levels=np.linspace(-1.2, 1.8, 25), cmap="viridis", extend="both")
        axes.contour(x, y, values, levels=np.linspace(-1.2, 1.8, 13), colors="white", linewidths=0.4)
        axes.set_aspect("equal")
        axes.set_title(title, fontsize=10)
        axes.set_xticks([])
        axes.set_yticks([])
    figure.colorbar(drawn, ax=panels, shrink=0.85)
    target = folder / "taylor.png"
    figure.savefig(target, bbox_inches="tight")
    plt.close(figure)
    with Image.open(target) as picture:
        small = picture.convert("RGB")
        small.thumbnail((720, 720), Image.Resampling.LANCZOS)
    small.quantize(128, dither=Image.Dither.NONE).save(target, optimize=True)
