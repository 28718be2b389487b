"""Finished runs with fields given by formulas, for tests of files, pictures and the report."""

from __future__ import annotations

from dataclasses import replace
from datetime import UTC, datetime

import numpy as np

from rfm.app.record import LinearFacts, Provenance, Residual, RunRecord
from rfm.geometry.primitives_2d import disk
from rfm.geometry.primitives_3d import ball, cylinder
from rfm.geometry.shape import Shape
from solvers.classify import classify
from solvers.grid import Grid

TITLE = "Poisson on <an> annulus & $more"

CASE = {
    "rfm": 1,
    "title": TITLE,
    "parameters": {"R": 0.4, "r": 0.1},
    "geometry": {
        "shapes": {
            "outer": {"disk": {"center": [0.5, 0.5], "radius": 0.4}},
            "inner": {"disk": {"center": [0.5, 0.5], "radius": 0.1}},
        },
        "domain": "outer - inner",
    },
    "equation": {"poisson": {"source": "from exact", "conductivity": "1 + x^2", "reaction": 2}},
    "boundary_conditions": [
        {"on": ["outer"], "dirichlet": 0},
        {"on": ["inner"], "where": "x > 0.5", "robin": {"coefficient": "2 + y", "value": "x*y"}},
        {"on": ["inner"], "where": "x <= 0.5", "neumann": 1},
    ],
    "exact": "sin(3*x)*cos(2*y)",
    "discretization": {"basis": "web-spline", "degree": 3, "grid": 10},
}

RESIDUALS = (Residual("outer", "dirichlet", "0", 1.5e-16), Residual("inner", "neumann", "1", 2.5e-7))

STUDY = tuple(
    {
        "degree": degree,
        "grid": grid,
        "dofs": grid**2,
        "relative_l2_error": grid ** -(degree + 1.0),
        "rate_l2": None if grid == 8 else degree + 1.0,
    }
    for degree in (1, 2)
    for grid in (8, 16, 32)
)


def annulus() -> Shape:
    """Return the annulus of the cases."""
    return disk((0.5, 0.5), 0.4).named("outer") - disk((0.5, 0.5), 0.1).named("inner")


def ball_minus_cylinder() -> Shape:
    """Return the ball with a hole of the cases."""
    return ball((0, 0, 0), 1).named("ball") - cylinder((0, 0, 0), (0, 0, 1), 0.3).named("hole")


def wave(*coords):
    """Field shown in the pictures."""
    return np.sin(3 * coords[0]) * np.cos(2 * coords[1])


def record(shape: Shape | None = None, cells: int = 10, **changes) -> RunRecord:
    """Run on `shape` whose solution is off by 1e-6."""
    shape = shape or annulus()
    grid = Grid.cover(shape.box, cells)
    made = RunRecord(
        name="annulus",
        title=TITLE,
        case=CASE,
        summary={"status": "done", "dofs": 140, "relative_l2_error": 1.5e-9, "peak_memory_mb": 91.5},
        domain=shape,
        grid=grid,
        classification=classify(shape, grid),
        degree=3,
        basis="web-spline",
        coefficients=np.random.default_rng(3).standard_normal(tuple(grid.cells + 3)),
        u=lambda points: wave(*points.T) + 1e-6,
        gradient=np.ones_like,
        provenance=Provenance.collect(datetime.now(UTC)),
        exact=wave,
        residuals=RESIDUALS,
        timings={"geometry": 0.01, "solve": 0.03, "total": 0.05},
        linear=LinearFacts("superlu", "140 unknowns: sparse direct", 140, 3e-16),
        study=STUDY,
    )
    return replace(made, **changes)
