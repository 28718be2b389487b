"""How much memory a discretisation would need, and whether this computer has it.

The estimate counts what grows with the grid: the matrix in stencil form, of splines ``((2p + 1)^d + 1) / 2`` numbers
an unknown, its compressed copy and the copy with extended splines; the vectors; the states of the cells; and the
rules of the cut cells, whose number grows with the boundary.
"""

from __future__ import annotations

import math
import os
from pathlib import Path
from typing import TYPE_CHECKING

from rfm.errors import DiscretizationError

if TYPE_CHECKING:
    from rfm.app.case import Case
    from rfm.geometry.shape import Shape
    from solvers.problem import Discretization

FRACTION = 0.8
"""Part of the available memory that a run may use."""

MATRIX_COPIES = 8.0
"""Matrices in memory at the peak, in units of the half stencil with 8 bytes a number; the domain fills its box.
Measured, estimate / peak in GB: square of 768 cells, degree 2, 0.72 / 0.67; cube of 48 cells, degree 2, 0.74 / 0.51;
ball, 0.35 / 0.19, 1.5 / 0.7 and 9.8 / 4.0 for 32, 64 and 128 cells of degree 2, 1.8 / 0.8 for 48 of degree 3."""

BASE_BYTES = 150e6
"""Memory of the program itself with its chunks of quadrature points."""

CELL_BYTES = 40
"""Bytes a cell for its state and the tests that decide it."""


def required_bytes(domain: Shape, discretization: Discretization, components: int = 1) -> float:
    """Upper estimate of the memory of a solve for a field of `components`, which are all coupled."""
    from solvers.bases.registry import basis

    cells = grid_cells(domain, discretization)
    degree, dimension = discretization.degree, len(cells)
    chosen = basis(discretization.basis)
    unknowns, row = chosen.unknowns(degree, cells), chosen.row(degree, cells)
    rule = chosen.points(degree, min(10**6, int(max(cells))))
    points = discretization.quadrature_points or rule.cut
    border = 2.0 * sum(math.prod(cells) / n for n in cells)
    nodes = (rule.folded or 0) ** dimension + points**dimension
    unknowns, row = components * unknowns, components * row
    numbers: float = MATRIX_COPIES * row * unknowns + 10 * unknowns + 2 * nodes * border
    return BASE_BYTES + 8.0 * numbers + CELL_BYTES * math.prod(cells)


def grid_cells(domain: Shape, discretization: Discretization) -> tuple[float, ...]:
    """Cells in every direction; not rounded, so that a vast grid cannot overflow."""
    size = (discretization.box or domain.box).size
    spacing = discretization.spacing or max(size) / discretization.grid
    return tuple(max(1.0, math.ceil(length / spacing - 1e-9)) for length in size)


def available_bytes() -> float:
    """Memory that can be had now; infinite where the system does not tell."""
    free = math.inf
    try:
        lines = Path("/proc/meminfo").read_text().splitlines()
        free = next(1024.0 * int(line.split()[1]) for line in lines if line.startswith("MemAvailable"))
    except (OSError, StopIteration, ValueError):
        free = _free_pages()
    return min(free, _container_limit())


def require_memory(
    domain: Shape, discretization: Discretization, components: int = 1, share: float = 1.0
) -> None:
    """Refuse a discretisation that would not fit into a share of the available memory.

    Raises
    ------
    DiscretizationError
        Names the memory it would need, what is there, and the flag that allows it.
    """
    needed, available = required_bytes(domain, discretization, components), share * available_bytes()
    if needed > FRACTION * available:
        cells = " x ".join(f"{n:.0f}" for n in grid_cells(domain, discretization))
        raise DiscretizationError(
            f"{cells} cells of degree {discretization.degree} would need about {shown(needed)} of memory, "
            f"{shown(available)} are available; take a coarser grid or allow it with --allow-large"
        )


def refuse_large(case: Case, share: float = 1.0) -> None:
    """Refuse a case that would not fit into a share of the memory (see :func:`require_memory`)."""
    from rfm.app.build import build_discretization, build_domain, located

    domain = build_domain(case)
    try:
        require_memory(
            domain,
            build_discretization(case, domain),
            len(case.unknowns) * (2 if case.equation.inclusions else 1),
            share,
        )
    except DiscretizationError as error:
        raise located(case, error) from error


def shown(size: float) -> str:
    """Return a number of bytes in a readable unit."""
    for unit in ("B", "kB", "MB", "GB"):
        if size < 1000:
            return f"{size:.3g} {unit}"
        size /= 1000
    return f"{size:.3g} TB"


def _free_pages() -> float:
    names = getattr(os, "sysconf_names", {})
    if "SC_AVPHYS_PAGES" in names:
        return float(os.sysconf("SC_AVPHYS_PAGES")) * os.sysconf("SC_PAGE_SIZE")
    if "SC_PHYS_PAGES" in names:
        return float(os.sysconf("SC_PHYS_PAGES")) * os.sysconf("SC_PAGE_SIZE")
    return math.inf


def _container_limit() -> float:
    """What the control group of a container still allows."""
    folder = Path("/sys/fs/cgroup")
    try:
        limit = (folder / "memory.max").read_text().strip()
        used = int((folder / "memory.current").read_text())
        return math.inf if limit == "max" else float(int(limit) - used)
    except (OSError, ValueError):
        return math.inf
