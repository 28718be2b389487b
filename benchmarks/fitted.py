"""Poisson's equation by scikit-fem on a gmsh mesh whose edges follow the boundary to second order.

The degree of the elements ends at 4 on triangles and 2 on tetrahedra, that of the geometry at 2; that is what
the program offers.  The solver is SuperLU in the symmetric mode, several times faster than its default, or
conjugate gradients with PyAMG, whichever was faster at the size.
"""

from __future__ import annotations

import logging
from typing import Any

import gmsh
import numpy as np
import skfem
from problems import Benchmark
from record import Laps, Row
from scipy.sparse.linalg import cg, splu
from scipy.spatial import cKDTree
from skfem.helpers import dot, grad

logging.getLogger("skfem").setLevel(logging.ERROR)

ELEMENTS = {
    2: {2: skfem.ElementTriP2, 3: skfem.ElementTriP3, 4: skfem.ElementTriP4},
    3: {2: skfem.ElementTetP2},
}
EDGES = {2: ((0, 1), (1, 2), (2, 0)), 3: ((0, 1), (1, 2), (2, 0), (3, 0), (3, 2), (3, 1))}
"""Vertices of the edges whose midpoints gmsh lists after the vertices of a triangle, a tetrahedron."""

GMSH_TYPE = {2: (9, 6), 3: (11, 10)}
DIRECT_BELOW = {2: 200_000, 3: 12_000}
"""Unknowns up to which the direct solver is the faster one."""


def mesh(benchmark: Benchmark, size: float) -> Any:
    """Second-order mesh of elements not larger than `size`.

    scikit-fem wants the vertices of a triangle sorted, and its elements of degree 3 and 4 are wrong on a mesh
    of six-node triangles that are not.  So the straight mesh is built first and its midpoints are moved.
    """
    dim = benchmark.dimension
    kind, n_nodes = GMSH_TYPE[dim]
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        benchmark.draw()
        gmsh.model.occ.synchronize()
        gmsh.option.setNumber("Mesh.MeshSizeMin", size)
        gmsh.option.setNumber("Mesh.MeshSizeMax", size)
        gmsh.model.mesh.generate(dim)
        gmsh.model.mesh.setOrder(2)
        tags, flat, _ = gmsh.model.mesh.getNodes()
        connectivity = gmsh.model.mesh.getElementsByType(kind)[1]
    finally:
        gmsh.finalize()
    place = np.zeros(int(tags.max()) + 1, dtype=np.int64)
    place[tags.astype(np.int64)] = np.arange(len(tags))
    nodes = flat.reshape(-1, 3)[:, :dim]
    cells = place[connectivity.astype(np.int64)].reshape(-1, n_nodes)

    vertices, corners = np.unique(cells[:, : dim + 1], return_inverse=True)
    straight = (skfem.MeshTri if dim == 2 else skfem.MeshTet)(
        nodes[vertices].T, corners.reshape(-1, dim + 1).T
    )
    curved = (skfem.MeshTri2 if dim == 2 else skfem.MeshTet2).from_mesh(straight)
    middles = np.concatenate([cells[:, dim + 1 + e] for e in range(len(EDGES[dim]))])
    ends = np.concatenate([cells[:, list(edge)] for edge in EDGES[dim]])
    positions = curved.doflocs.copy()
    edge_dofs = np.arange(len(vertices), positions.shape[1])
    distance, nearest = cKDTree(nodes[ends].mean(axis=1)).query(positions[:, edge_dofs].T)
    if distance.max() > 1e-10:
        raise RuntimeError("the midpoints of gmsh's edges do not belong to scikit-fem's")
    positions[:, edge_dofs] = nodes[middles[nearest]].T
    return type(curved)(positions, curved.t)


def solve_linear(matrix: Any, load: Any, dim: int) -> Any:
    """Solution of the symmetric positive definite system by the faster of two solvers."""
    if matrix.shape[0] <= DIRECT_BELOW[dim]:
        options = {"SymmetricMode": True, "DiagPivotThresh": 0.0}
        return splu(matrix.tocsc(), permc_spec="MMD_AT_PLUS_A", options=options).solve(load)
    import pyamg

    levels = pyamg.smoothed_aggregation_solver(matrix.tocsr(), max_coarse=500)
    x, info = cg(matrix, load, rtol=1e-11, M=levels.aspreconditioner(), maxiter=1000)
    if info != 0:
        raise RuntimeError(f"conjugate gradients did not converge: {info}")
    return x


def solve(benchmark: Benchmark, degree: int, size: float, laps: Laps) -> Row:
    """Mesh, assemble and solve once; the error is computed outside the time."""
    fine = mesh(benchmark, size)
    laps.lap("geometry")
    element = ELEMENTS[benchmark.dimension][degree]()
    basis = skfem.Basis(fine, element)
    matrix = skfem.BilinearForm(lambda u, v, w: dot(grad(u), grad(v))).assemble(basis)
    load = skfem.LinearForm(lambda v, w: benchmark.source(*w.x) * v).assemble(basis)
    boundary = basis.get_dofs().flatten()
    inner = basis.complement_dofs(boundary)
    x = np.zeros(basis.N)
    x[boundary] = benchmark.exact(*basis.doflocs[:, boundary])
    rows = matrix[inner]
    load = load[inner] - rows[:, boundary] @ x[boundary]
    matrix = rows[:, inner]
    laps.lap("assembly")
    x[inner] = solve_linear(matrix, load, benchmark.dimension)
    laps.lap("solve")

    norm = skfem.Basis(fine, element, intorder=min(2 * degree + 4, 14 if benchmark.dimension == 2 else 8))
    exact = benchmark.exact(*norm.global_coordinates())
    difference = np.asarray(norm.interpolate(x)) - exact
    error = float(np.sqrt((difference**2 * norm.dx).sum() / (exact**2 * norm.dx).sum()))
    return Row("scikit-fem", benchmark.name, degree, f"{size:.4g}", len(inner), error, laps.seconds)
