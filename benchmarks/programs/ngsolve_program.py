"""NGSolve with Netgen's geometry kernel: meshes curved to the degree, inner unknowns condensed.

In the plane its best is high degree on the coarsest mesh with a sparse Cholesky factor; in space degrees 3 to 5 with
conjugate gradients and the BDDC preconditioner, tried with one thread and with two.  The corner of the L-shape is
refined geometrically with one layer a degree.  The plate is solved by the hybridised Hellan-Herrmann-Johnson method.
"""

from __future__ import annotations

import platform
from collections.abc import Callable, Mapping
from importlib.metadata import version
from types import SimpleNamespace
from typing import Any

import ngsolve as ng
from netgen.occ import Circle, Cylinder, MoveTo, OCCGeometry, Pnt, Sphere, Z

from benchmarks.problems import LAMBDA, MU, Ball, Block, Bore, Polygon, Problem, kirsch_stress
from benchmarks.programs import refined
from benchmarks.record import Answer, Configuration, Laps

ng.ngsglobals.msg_level = 0

MATHS = SimpleNamespace(
    sin=ng.sin, cos=ng.cos, exp=ng.exp, cosh=lambda t: 0.5 * (ng.exp(t) + ng.exp(-t)), arctan2=ng.atan2
)

TOP_DEGREE = 14
COARSEST = {"annulus, sine": 0.2, "annulus": 0.2, "plate with three holes": 1.0, "Kirsch plate": 0.6}
"""Mesh sizes for raising the degree on a fixed mesh."""

EXTRA_ORDER = 6
"""Degree of exactness beyond twice the degree, for error norms."""


def series(problem: Problem) -> Mapping[str, list[Configuration]]:
    """Higher degrees on a coarse mesh, and finer meshes at a few degrees."""
    if problem.equation == "plate":
        return {f"HHJ p={p}": refined("size", 0.7, 1.6, 10, degree=p) for p in (4, 5, 6, 3)}
    if isinstance(problem.outer, Polygon):
        return {
            f"hp, size {size}": [{"size": size, "degree": p, "layers": p + 1} for p in range(2, 13)]
            for size in (0.5, 0.25, 0.15)
        }
    if problem.dimension == 3:
        iterative = {"solver": "bddc"}
        return {
            "p=5 BDDC": refined("size", 0.4, 1.5, 7, degree=5, **iterative),
            "p=5 BDDC, 2 threads": refined("size", 0.4, 1.5, 7, degree=5, threads=2, **iterative),
            **{f"p={p} BDDC": refined("size", 0.4, 1.5, 7, degree=p, **iterative) for p in (3, 4, 6)},
            "raised BDDC": [{"size": 0.6, "degree": p, **iterative} for p in range(2, 11)],
            **{f"p={p}": refined("size", 0.6, 1.5, 8, degree=p, solver="sparsecholesky") for p in (3, 2)},
        }
    size = COARSEST[problem.name]
    return {
        "raised": [{"size": size, "degree": p} for p in range(2, TOP_DEGREE + 1)],
        **{f"p={p}": refined("size", size, 1.6, 9, degree=p) for p in (6, 8, 4, 3)},
    }


def _block(one: Block) -> Any:
    (x, y), (right, top) = one.low, one.high
    face = MoveTo(x, y).Rectangle(right - x, top - y).Face()
    for edge in face.edges:
        middle = edge.center
        sides = {
            "left": middle.x - x,
            "right": right - middle.x,
            "bottom": middle.y - y,
            "top": top - middle.y,
        }
        edge.name = min(sides, key=lambda name: sides[name])
    return face


def _ball(one: Ball) -> Any:
    if len(one.center) == 2:
        return Circle(one.center, one.radius).Face()
    return Sphere(Pnt(*one.center), one.radius)


def _polygon(one: Polygon) -> Any:
    pen = MoveTo(*one.vertices[0])
    for vertex in one.vertices[1:]:
        pen = pen.LineTo(*vertex)
    face = pen.Close().Face()
    for vertex in face.vertices:
        if abs(vertex.p[0]) + abs(vertex.p[1]) < 1e-9:
            vertex.hpref = 1  # the corner that is refined
    return face


SOLIDS: Mapping[type, Callable[[Any], Any]] = {
    Ball: _ball,
    Block: _block,
    Bore: lambda one: Cylinder(Pnt(0, 0, -2), Z, r=one.radius, h=4),
    Polygon: _polygon,
}


def mesh(problem: Problem, configuration: Configuration) -> Any:
    """Mesh of the domain."""
    solid = SOLIDS[type(problem.outer)](problem.outer)
    for hole in problem.holes:
        solid = solid - SOLIDS[type(hole)](hole)
    geometry = OCCGeometry(solid, dim=problem.dimension)
    # meshing in parallel gains nothing at these sizes, and its threads wait in loops when a core is busy
    result = ng.Mesh(geometry.GenerateMesh(maxh=configuration["size"], parallel_meshing=False))
    if "layers" in configuration:
        result.RefineHP(configuration["layers"], factor=0.15)
    else:
        result.Curve(configuration["degree"])
    return result


def formula(problem: Problem, name: str) -> Any:
    """One of the formulas of a problem as a coefficient function."""
    value = getattr(problem, name)(MATHS, *(ng.x, ng.y, ng.z)[: problem.dimension])
    return ng.CF(value)


def finish(form: Any, load: Any, field: Any, solver: str, laps: Laps) -> None:
    """Assemble with condensation, solve, recover the inner unknowns."""
    preconditioner = ng.Preconditioner(form, "bddc") if solver == "bddc" else None
    form.Assemble()
    load.Assemble()
    residual = load.vec.CreateVector()
    residual.data = load.vec - form.mat * field.vec
    residual.data += form.harmonic_extension_trans * residual
    laps.lap("assembly")
    if preconditioner is None:
        inverse = form.mat.Inverse(field.space.FreeDofs(True), inverse=solver)
    else:
        inverse = ng.krylovspace.CGSolver(form.mat, preconditioner.mat, tol=1e-12, maxiter=500)
    field.vec.data += inverse * residual
    field.vec.data += form.harmonic_extension * field.vec
    field.vec.data += form.inner_solve * residual
    laps.lap("solve")


def relative(field: Any, exact: Any, where: Any, degree: int) -> float:
    """Relative error over the mesh."""

    def norm(value: Any) -> Any:
        return ng.Integrate(ng.InnerProduct(value, value), where, order=2 * degree + EXTRA_ORDER) ** 0.5

    return float(norm(field - exact) / norm(exact))


def _poisson(problem: Problem, where: Any, configuration: Configuration, laps: Laps) -> tuple[Any, Any]:
    space = ng.H1(where, order=configuration["degree"], dirichlet=".*")
    u, v = space.TnT()
    form = ng.BilinearForm(ng.grad(u) * ng.grad(v) * ng.dx, condense=True, symmetric=True)
    load = ng.LinearForm(space)
    if problem.source is not None:
        load += formula(problem, "source") * v * ng.dx(bonus_intorder=2)
    field = ng.GridFunction(space)
    if problem.data is not None:
        field.Set(formula(problem, "data"), definedon=where.Boundaries(".*"))
    finish(form, load, field, configuration.get("solver", "sparsecholesky"), laps)
    return space, field


def _elasticity(problem: Problem, where: Any, configuration: Configuration, laps: Laps) -> tuple[Any, Any]:
    space = ng.VectorH1(where, order=configuration["degree"], dirichletx="left", dirichlety="bottom")
    u, v = space.TnT()
    strain = ng.Sym(ng.grad(u))
    energy = LAMBDA * ng.Trace(strain) * ng.div(v) + 2 * MU * ng.InnerProduct(strain, ng.Sym(ng.grad(v)))
    form = ng.BilinearForm(energy * ng.dx, condense=True, symmetric=True)
    xx, yy, xy = kirsch_stress(MATHS, ng.x, ng.y)
    load = ng.LinearForm(space)
    load += (xx * v[0] + xy * v[1]) * ng.ds("right", bonus_intorder=4)
    load += (xy * v[0] + yy * v[1]) * ng.ds("top", bonus_intorder=4)
    field = ng.GridFunction(space)
    finish(form, load, field, "sparsecholesky", laps)
    return space, field


def _plate(problem: Problem, where: Any, configuration: Configuration, laps: Laps) -> tuple[Any, Any]:
    degree = configuration["degree"]
    moments = ng.HDivDiv(where, order=degree - 1, discontinuous=True)
    deflections = ng.H1(where, order=degree, dirichlet=".*")
    slopes = ng.NormalFacetFESpace(where, order=degree - 1, dirichlet=".*")
    space = moments * deflections * slopes
    (s, w, a), (t, v, b) = space.TnT()
    n = ng.specialcf.normal(2)
    hesse = lambda one: one.Operator("hesse")  # noqa: E731
    bending = lambda one: ng.InnerProduct(one * n, n)  # noqa: E731
    inside = -ng.InnerProduct(s, t) + ng.InnerProduct(s, hesse(v)) + ng.InnerProduct(t, hesse(w))
    edges = bending(s) * (ng.grad(v) - b) * n + bending(t) * (ng.grad(w) - a) * n
    form = ng.BilinearForm(
        inside * ng.dx(bonus_intorder=2) - edges * ng.dx(element_boundary=True, bonus_intorder=2),
        condense=True,
        symmetric=True,
    )
    field = ng.GridFunction(space)
    load = ng.LinearForm(formula(problem, "source") * v * ng.dx(bonus_intorder=4))
    finish(form, load, field, "sparsecholesky", laps)
    return space, field.components[1]


EQUATIONS = {"poisson": _poisson, "elasticity": _elasticity, "plate": _plate}


def solve(problem: Problem, configuration: Configuration, laps: Laps) -> Answer:
    """Mesh, assemble and solve once."""
    where = mesh(problem, configuration)
    laps.lap("geometry")
    arguments = problem, where, configuration, laps
    if configuration.get("threads", 1) > 1:
        ng.SetNumThreads(configuration["threads"])
        with ng.TaskManager():
            space, field = EQUATIONS[problem.equation](*arguments)
    else:
        space, field = EQUATIONS[problem.equation](*arguments)
    exact = formula(problem, "exact")
    return Answer(space.ndof, lambda: relative(field, exact, where, configuration["degree"]))


def versions() -> Mapping[str, str]:
    """Versions of what ran."""
    return {
        "python": platform.python_version(),
        **{name: version(name) for name in ("ngsolve", "netgen-mesher")},
    }
