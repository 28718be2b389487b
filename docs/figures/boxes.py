"""Figure of docs/scaling.md: an annulus on eight boxes of cells, and the unknowns that one box needs from others."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from PIL import Image

from rfm.geometry import disk
from solvers.background import background_grid
from solvers.classify import classify
from solvers.device.blocks import divided
from solvers.device.halo import Halo
from solvers.problem import Discretization
from solvers.web import SplineSpace

INK = "#222222"
DEGREE, BOX = 2, 2


def render(folder: Path) -> None:
    """Write boxes.png."""
    centre = (0.5, 0.5)
    domain = disk(center=centre, radius=0.4).named("outer") - disk(center=centre, radius=0.13).named("inner")
    grid = background_grid(domain, Discretization(grid=28))
    classification = classify(domain, grid)
    space = SplineSpace.build(grid, DEGREE, classification)
    blocks = divided(classification.state, DEGREE, 8)
    halo = Halo(space, blocks)
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.2, 5.0), layout="constrained")
    figure.get_layout_engine().set(h_pad=0.12, w_pad=0.12)
    index = np.stack(np.unravel_index(space.free.dofs, space.shape))
    middle = grid.lower[:, None] + grid.spacing[:, None] * (index + (1 - DEGREE) / 2)
    colours = plt.get_cmap("tab10")(np.arange(8))
    requests = halo.requests(BOX, halo.local(BOX))
    needed = np.concatenate(list(requests.values()))
    for axes in (left, right):
        for axis, border in enumerate(blocks.borders):
            for layer in border:
                where = grid.lower[axis] + grid.spacing[axis] * layer
                (axes.axvline if axis == 0 else axes.axhline)(where, color=INK, linewidth=1.0)
        for radius in (0.4, 0.13):
            axes.add_patch(plt.Circle(centre, radius, fill=False, color=INK, linewidth=1.4))
        axes.set_aspect("equal")
        axes.set_axis_off()
    for box, own in enumerate(halo.own):
        left.scatter(*middle[:, own], s=13, color=colours[box], linewidths=0)
    left.set_title("unknowns of the inner splines, by box", fontsize=10, color=INK)
    right.scatter(*middle, s=7, color="#d0d0d0", linewidths=0)
    right.scatter(*middle[:, halo.own[BOX]], s=13, color=colours[BOX], linewidths=0, label="held")
    colour = [colours[holder] for holder in halo.holder[needed]]
    right.scatter(
        *middle[:, needed], s=26, color=colour, marker="s", linewidths=0, label="needed from others"
    )
    right.set_title("one box: held (dots), needed from others (squares)", fontsize=10, color=INK)
    path = folder / "boxes.png"
    figure.savefig(path, dpi=76)
    plt.close(figure)
    with Image.open(path) as picture:
        picture.convert("RGB").quantize(48).save(path, optimize=True)
