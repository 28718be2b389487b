"""nutils: B-splines on a grid trimmed by level sets, symmetric Nitsche, SciPy's direct solver.

A trimmed cell is halved a number of times and then cut along straight lines, so the error of the geometry is of second
order in the smallest piece; the number grows with the degree and the grid to keep up.  Small pieces of basis functions
are not stabilised, the program offers nothing ready for it.  Everything runs as Python on NumPy.
"""

from __future__ import annotations

import platform
from collections.abc import Mapping
from importlib.metadata import version
from math import ceil, log2
from typing import Any

import numpy as np
import treelog
from nutils import function, matrix, mesh
from nutils.expression_v2 import Namespace
from nutils.solver import System

from benchmarks.problems import LAMBDA, MU, Ball, Block, Bore, Problem, Solid, kirsch_stress
from benchmarks.record import Answer, Configuration, Laps

treelog.current = treelog.FilterLog(treelog.StdoutLog(), minlevel=treelog.proto.Level.error)

MARGIN = 0.03
NITSCHE = 10.0

DEGREES = {"poisson": {2: (3, 2, 5), 3: (3, 2)}, "elasticity": {2: (3, 2)}, "plate": {2: (4, 3)}}
START = {2: 6, 3: 4}
HALVINGS = {2: 2, 3: 1}
"""Cells a side and halvings of trimmed cells on the coarsest grid."""


def series(problem: Problem) -> Mapping[str, list[Configuration]]:
    """Finer grids at every degree, trimmed cells halved more often as the degree asks."""
    if problem.name == "L-shape":
        return {}
    order = lambda p: 1 if problem.dimension == 3 else max(0.0, (p + 1) / 2 - 1)  # noqa: E731
    return {
        f"p={p}": [
            {
                "degree": p,
                "cells": int(START[problem.dimension] * 1.6**i),
                "halvings": HALVINGS[problem.dimension] + ceil(order(p) * i * log2(1.6)),
            }
            for i in range(7)
        ]
        for p in DEGREES[problem.equation][problem.dimension]
    }


def inside(solid: Solid, geometry: Any) -> Any:
    """Positive inside a ball or a bore."""
    assert isinstance(solid, Ball | Bore)
    center = solid.center if isinstance(solid, Ball) else (0.0, 0.0)
    squares = [(geometry[i] - c) ** 2 for i, c in enumerate(center)]
    return solid.radius**2 - sum(squares[1:], squares[0])


def trimmed(problem: Problem, configuration: Configuration) -> tuple[Any, Any, float]:
    """Topology, geometry and spacing."""
    outer, halvings = problem.outer, configuration["halvings"]
    if isinstance(outer, Block):
        bounds = list(zip(outer.low, outer.high, strict=True))
    else:
        assert isinstance(outer, Ball)
        reach = outer.radius * (1 + MARGIN)
        bounds = [(c - reach, c + reach) for c in outer.center]
    nodes = [np.linspace(low, high, configuration["cells"] + 1) for low, high in bounds]
    topology, geometry = mesh.rectilinear(nodes)
    if isinstance(outer, Ball):
        topology = topology.trim(inside(outer, geometry), maxrefine=halvings)
    for hole in problem.holes:
        topology = topology.trim(-inside(hole, geometry), maxrefine=halvings)
    return topology, geometry, float(nodes[0][1] - nodes[0][0])


def namespace(
    problem: Problem, topology: Any, geometry: Any, degree: int, components: int = 0
) -> tuple[Any, int]:
    """Names for expressions, and the number of unknowns."""
    names = Namespace()
    names.x = geometry
    names.define_for("x", gradient="∇", normal="n", jacobians=("dV", "dS"))
    basis = topology.basis("spline", degree=degree)
    names.add_field(("u", "v"), basis, shape=(components,) if components else ())
    coordinates = list(geometry)
    exact = problem.exact(np, *coordinates)
    names.U = np.stack(exact) if components else exact
    names.f = problem.source(np, *coordinates) if problem.source else np.zeros(())
    return names, len(basis) * max(components, 1)


def _poisson(problem: Problem, topology: Any, names: Any, degree: int, spacing: float) -> Any:
    names.beta = NITSCHE * degree**2 / spacing
    names.g = names.U if problem.data else np.zeros(())
    volume = topology.integral("(∇_i(u) ∇_i(v) - f v) dV" @ names, degree=2 * degree)
    weak = "(-∇_i(u) n_i v - ∇_i(v) n_i (u - g) + beta (u - g) v) dS"
    return volume + topology.boundary.integral(weak @ names, degree=2 * degree)


def _elasticity(problem: Problem, topology: Any, names: Any, degree: int, spacing: float) -> Any:
    names.lam, names.mu, names.beta = LAMBDA, MU, 2 * NITSCHE * degree**2 / spacing
    names.δ = np.eye(2)
    names.s_ij = "lam ∇_k(u_k) δ_ij + mu (∇_j(u_i) + ∇_i(u_j))"
    names.r_ij = "lam ∇_k(v_k) δ_ij + mu (∇_j(v_i) + ∇_i(v_j))"
    xx, yy, xy = kirsch_stress(np, *names.x)
    names.t = np.stack([np.stack([xx, xy]), np.stack([xy, yy])])
    form = topology.integral("∇_j(v_i) s_ij dV" @ names, degree=2 * degree)
    loaded = topology.boundary["right,top"]
    form -= loaded.integral("t_ij n_j v_i dS" @ names, degree=2 * degree + 4)
    for side, component in (("left", 0), ("bottom", 1)):  # rollers: the displacement across is zero
        names.e = np.eye(2)[component]
        weak = "(-s_ij n_j e_i e_k v_k - r_ij n_j e_i e_k u_k + beta e_i u_i e_k v_k) dS"
        form += topology.boundary[side].integral(weak @ names, degree=2 * degree)
    return form


def _plate(problem: Problem, topology: Any, names: Any, degree: int, spacing: float) -> Any:
    names.b = NITSCHE * degree**2 / spacing
    names.c = NITSCHE**2 * degree**6 / 36 / spacing**3
    names.Lu, names.Lv = "∇_i(∇_i(u))", "∇_i(∇_i(v))"
    form = topology.integral("(Lu Lv - f v) dV" @ names, degree=2 * degree)
    weak = (
        "(-Lu ∇_i(v) n_i - Lv ∇_i(u) n_i + ∇_i(Lu) n_i v + ∇_i(Lv) n_i u"
        " + b ∇_i(u) n_i ∇_j(v) n_j + c u v) dS"
    )
    return form + topology.boundary.integral(weak @ names, degree=2 * degree)


EQUATIONS = {"poisson": _poisson, "elasticity": _elasticity, "plate": _plate}


def solve(problem: Problem, configuration: Configuration, laps: Laps) -> Answer:
    """Trim, assemble and solve once."""
    degree = configuration["degree"]
    topology, geometry, spacing = trimmed(problem, configuration)
    laps.lap("geometry")
    components = 2 if problem.equation == "elasticity" else 0
    names, unknowns = namespace(problem, topology, geometry, degree, components)
    form = EQUATIONS[problem.equation](problem, topology, names, degree, spacing)
    with matrix.backend("scipy"):
        system = System(form, trial="u", test="v")
        arguments, x = system.deconstruct({}, {})
        jacobian, residual = system.assemble_jacobian_residual(arguments, x)
        laps.lap("assembly")
        x -= jacobian.solve(residual, solver="direct")
        laps.lap("solve")
        arguments = system.construct(arguments, x)
    square = "(u_i - U_i) (u_i - U_i) dV", "U_i U_i dV"
    if not components:
        square = "(u - U)^2 dV", "U^2 dV"

    def error() -> float:
        integrals = [topology.integral(one @ names, degree=2 * degree + 4) for one in square]
        difference, size = function.eval(integrals, arguments)
        return float(np.sqrt(difference / size))

    return Answer(unknowns, error)


def versions() -> Mapping[str, str]:
    """Versions of what ran."""
    return {
        "python": platform.python_version(),
        **{name: version(name) for name in ("nutils", "numpy", "scipy")},
    }
