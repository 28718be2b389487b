"""scikit-fem on gmsh meshes whose edges follow the boundary to second order.

The degree of the elements ends at 4 on triangles and 2 on tetrahedra, that of the geometry at 2; that is what the
program offers.  The solver is SuperLU in the symmetric mode, several times faster than its default, or conjugate
gradients with PyAMG, whichever was faster at the size.  The plate has Morley's element and Argyris's on a straight
mesh; the mesh of the L-shape is bisected towards the corner.
"""

from __future__ import annotations

import logging
import platform
from collections.abc import Callable, Mapping
from importlib.metadata import version
from typing import Any

import gmsh
import numpy as np
import skfem
from scipy.sparse.linalg import cg, splu
from scipy.spatial import cKDTree
from skfem.helpers import dd, ddot, dot, grad, sym_grad, trace

from benchmarks.problems import LAMBDA, MU, SIDE, Ball, Block, Bore, Polygon, Problem, kirsch_stress
from benchmarks.programs import refined
from benchmarks.record import Answer, Configuration, Laps

logging.getLogger("skfem").setLevel(logging.ERROR)

ELEMENTS = {
    2: {2: skfem.ElementTriP2, 3: skfem.ElementTriP3, 4: skfem.ElementTriP4},
    3: {2: skfem.ElementTetP2},
}
PLATES = {"morley": skfem.ElementTriMorley, "argyris": skfem.ElementTriArgyris}
MESHES = {2: (skfem.MeshTri, skfem.MeshTri2), 3: (skfem.MeshTet, skfem.MeshTet2)}
"""Straight and second-order meshes."""

EDGES = {2: ((0, 1), (1, 2), (2, 0)), 3: ((0, 1), (1, 2), (2, 0), (3, 0), (3, 2), (3, 1))}
"""Vertices of the edges whose midpoints gmsh lists after the vertices of a triangle, a tetrahedron."""

GMSH_TYPE = {2: (9, 6), 3: (11, 10)}
DIRECT_BELOW = {2: 200_000, 3: 12_000}
"""Unknowns up to which the direct solver is the faster one."""

NORM_ORDER = {2: 14, 3: 8}
COARSEST = {"annulus, sine": 0.1, "annulus": 0.1, "plate with three holes": 0.25, "Kirsch plate": 0.5}


def series(problem: Problem) -> Mapping[str, list[Configuration]]:
    """Finer meshes at every degree."""
    if problem.equation == "plate":
        return {name: refined("size", 0.4, 1.6, 10, element=name) for name in PLATES}
    if isinstance(problem.outer, Polygon):
        return {
            f"p={p}": [
                {"size": 0.5 / 2 ** (i / 2), "degree": p, "layers": i * (p + 1) + 2} for i in range(12)
            ]
            for p in (4, 3, 2)
        }
    start, factor = (0.4, 1.5) if problem.dimension == 3 else (COARSEST[problem.name], 1.6)
    return {
        f"p={p}": refined("size", start, factor, 10, degree=p)
        for p in sorted(ELEMENTS[problem.dimension], reverse=True)
    }


def _ball(one: Ball) -> int:
    if len(one.center) == 2:
        return int(gmsh.model.occ.addDisk(*one.center, 0, one.radius, one.radius))
    return int(gmsh.model.occ.addSphere(*one.center, one.radius))


def _block(one: Block) -> int:
    (x, y), (right, top) = one.low, one.high
    return int(gmsh.model.occ.addRectangle(x, y, 0, right - x, top - y))


def _polygon(one: Polygon) -> int:
    occ = gmsh.model.occ
    points = [occ.addPoint(x, y, 0) for x, y in one.vertices]
    lines = [occ.addLine(a, b) for a, b in zip(points, points[1:] + points[:1], strict=True)]
    return int(occ.addPlaneSurface([occ.addCurveLoop(lines)]))


SOLIDS: Mapping[type, Callable[[Any], int]] = {
    Ball: _ball,
    Block: _block,
    Bore: lambda one: int(gmsh.model.occ.addCylinder(0, 0, -2, 0, 0, 4, one.radius)),
    Polygon: _polygon,
}


def _generated(problem: Problem, size: float) -> tuple[Any, Any]:
    """Nodes and second-order cells of gmsh."""
    dimension = problem.dimension
    kind, n_nodes = GMSH_TYPE[dimension]
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        outer, *holes = ((dimension, SOLIDS[type(one)](one)) for one in (problem.outer, *problem.holes))
        if holes:
            gmsh.model.occ.cut([outer], holes)
        gmsh.model.occ.synchronize()
        gmsh.option.setNumber("Mesh.MeshSizeMin", size)
        gmsh.option.setNumber("Mesh.MeshSizeMax", size)
        gmsh.model.mesh.generate(dimension)
        gmsh.model.mesh.setOrder(2)
        tags, flat, _ = gmsh.model.mesh.getNodes()
        connectivity = gmsh.model.mesh.getElementsByType(kind)[1]
    finally:
        gmsh.finalize()
    place = np.zeros(int(tags.max()) + 1, dtype=np.int64)
    place[tags.astype(np.int64)] = np.arange(len(tags))
    return flat.reshape(-1, 3)[:, :dimension], place[connectivity.astype(np.int64)].reshape(-1, n_nodes)


def mesh(problem: Problem, configuration: Configuration) -> Any:
    """Mesh of the domain: straight for the plate and the L-shape, else of second order.

    scikit-fem wants the vertices of a triangle sorted, and its elements of degree 3 and 4 are wrong on a mesh of
    six-node triangles that are not.  So the straight mesh is built first and its midpoints are moved.
    """
    dimension = problem.dimension
    nodes, cells = _generated(problem, configuration["size"])
    vertices, corners = np.unique(cells[:, : dimension + 1], return_inverse=True)
    straight_kind, curved_kind = MESHES[dimension]
    straight = straight_kind(nodes[vertices].T, corners.reshape(-1, dimension + 1).T)
    if "layers" in configuration:
        for _ in range(configuration["layers"]):
            at_corner = (np.abs(straight.p[:, straight.t]).sum(axis=0) < 1e-14).any(axis=0)
            straight = straight.refined(np.flatnonzero(at_corner))
    if "layers" in configuration or problem.equation == "plate":
        return straight
    curved = curved_kind.from_mesh(straight)
    middles = np.concatenate([cells[:, dimension + 1 + e] for e in range(len(EDGES[dimension]))])
    ends = np.concatenate([cells[:, list(edge)] for edge in EDGES[dimension]])
    positions = curved.doflocs.copy()
    edge_dofs = np.arange(len(vertices), positions.shape[1])
    distance, nearest = cKDTree(nodes[ends].mean(axis=1)).query(positions[:, edge_dofs].T)
    if distance.max() > 1e-10:
        raise RuntimeError("the midpoints of gmsh's edges do not belong to scikit-fem's")
    positions[:, edge_dofs] = nodes[middles[nearest]].T
    return curved_kind(positions, curved.t)


def solve_linear(matrix: Any, load: Any, dimension: int) -> Any:
    """Solution of the symmetric positive definite system by the faster of two solvers."""
    if matrix.shape[0] <= DIRECT_BELOW[dimension]:
        options = {"SymmetricMode": True, "DiagPivotThresh": 0.0}
        return splu(matrix.tocsc(), permc_spec="MMD_AT_PLUS_A", options=options).solve(load)
    import pyamg

    levels = pyamg.smoothed_aggregation_solver(matrix.tocsr(), max_coarse=500)
    x, info = cg(matrix, load, rtol=1e-11, M=levels.aspreconditioner(), maxiter=1000)
    if info != 0:
        raise RuntimeError(f"conjugate gradients did not converge: {info}")
    return x


def _load(problem: Problem, basis: Any) -> Any:
    if problem.source is None:
        return np.zeros(basis.N)
    source = problem.source
    return skfem.LinearForm(lambda v, w: source(np, *w.x) * v).assemble(basis)


def _poisson(problem: Problem, where: Any, configuration: Configuration) -> tuple[Any, ...]:
    basis = skfem.Basis(where, ELEMENTS[problem.dimension][configuration["degree"]]())
    matrix = skfem.BilinearForm(lambda u, v, w: dot(grad(u), grad(v))).assemble(basis)
    held = basis.get_dofs().flatten()
    x = np.zeros(basis.N)
    x[held] = problem.exact(np, *basis.doflocs[:, held])
    return basis, matrix, _load(problem, basis), held, x


def _elasticity(problem: Problem, where: Any, configuration: Configuration) -> tuple[Any, ...]:
    element = skfem.ElementVector(ELEMENTS[2][configuration["degree"]]())
    basis = skfem.Basis(where, element)

    def energy(u: Any, v: Any, w: Any) -> Any:
        strain, test = sym_grad(u), sym_grad(v)
        return LAMBDA * trace(strain) * trace(test) + 2 * MU * ddot(strain, test)

    def traction(v: Any, w: Any) -> Any:
        xx, yy, xy = kirsch_stress(np, *w.x)
        n = w.n
        return (xx * n[0] + xy * n[1]) * v[0] + (xy * n[0] + yy * n[1]) * v[1]

    sides = where.facets_satisfying(lambda x: np.maximum(x[0], x[1]) > SIDE - 1e-9, boundaries_only=True)
    load = skfem.LinearForm(traction).assemble(skfem.FacetBasis(where, element, facets=sides))
    held = np.concatenate(
        [
            _component(basis.get_dofs(lambda x: np.abs(x[0]) < 1e-9), 1),
            _component(basis.get_dofs(lambda x: np.abs(x[1]) < 1e-9), 2),
        ]
    )
    matrix = skfem.BilinearForm(energy).assemble(basis)
    return basis, matrix, load, np.unique(held), np.zeros(basis.N)


def _component(dofs: Any, number: int) -> Any:
    """Unknowns of one component of a displacement, counted from 1 as in the names of scikit-fem."""
    return dofs.all([f"u^{number}"])


def _plate(problem: Problem, where: Any, configuration: Configuration) -> tuple[Any, ...]:
    basis = skfem.Basis(where, PLATES[configuration["element"]]())
    matrix = skfem.BilinearForm(lambda u, v, w: ddot(dd(u), dd(v))).assemble(basis)
    dofs = basis.get_dofs()
    # all unknowns of the edge but the second derivatives at its vertices
    held = dofs.all(["u", "u_x", "u_y", "u_n"]) if configuration["element"] == "argyris" else dofs.flatten()
    return basis, matrix, _load(problem, basis), held, np.zeros(basis.N)


EQUATIONS = {"poisson": _poisson, "elasticity": _elasticity, "plate": _plate}


def relative(problem: Problem, basis: Any, x: Any) -> float:
    """Relative error over the mesh."""
    order = min(2 * basis.elem.maxdeg + 4, NORM_ORDER[problem.dimension])
    norm = skfem.Basis(basis.mesh, basis.elem, intorder=order)
    exact = np.asarray(problem.exact(np, *norm.global_coordinates().value))
    difference = np.asarray(norm.interpolate(x).value) - exact
    return float(np.sqrt((difference**2 * norm.dx).sum() / (exact**2 * norm.dx).sum()))


def solve(problem: Problem, configuration: Configuration, laps: Laps) -> Answer:
    """Mesh, assemble and solve once."""
    where = mesh(problem, configuration)
    laps.lap("geometry")
    basis, matrix, load, held, x = EQUATIONS[problem.equation](problem, where, configuration)
    free = np.setdiff1d(np.arange(basis.N), held)
    rows = matrix[free]
    load = load[free] - rows[:, held] @ x[held]
    matrix = rows[:, free]
    laps.lap("assembly")
    x[free] = solve_linear(matrix, load, problem.dimension)
    laps.lap("solve")
    return Answer(len(free), lambda: relative(problem, basis, x))


def versions() -> Mapping[str, str]:
    """Versions of what ran."""
    names = ("scikit-fem", "gmsh", "numpy", "scipy")
    return {"python": platform.python_version(), **{name: version(name) for name in names}}
