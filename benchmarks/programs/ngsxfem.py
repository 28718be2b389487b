"""ngsxfem, the unfitted add-on of NGSolve: cut elements on a structured mesh, Nitsche's method, direct ghost penalty.

One smooth level set is followed to the degree of the elements by deforming the background mesh.  The ball with a
bore needs two, for its edges; those are available piecewise linear only.  Problems with straight sides all around are
left to NGSolve itself, and a plate would need a form of one's own.
"""

from __future__ import annotations

import platform
from collections.abc import Mapping
from functools import reduce
from importlib.metadata import version
from math import ceil
from typing import Any

import ngsolve as ng
from ngsolve.meshes import MakeStructured2DMesh, MakeStructured3DMesh
from xfem import (
    HASNEG,
    IF,
    NEG,
    CutInfo,
    GetDofsOfElements,
    GetFacetsWithNeighborTypes,
    InterpolateToP1,
    MultiLevelsetCutInfo,
    dCut,
    dFacetPatch,
)
from xfem.lsetcurv import LevelSetMeshAdaptation
from xfem.mlset import DomainTypeArray

from benchmarks.problems import LAMBDA, MU, Ball, Block, Bore, Problem, Solid, kirsch_stress
from benchmarks.programs import refined
from benchmarks.programs.ngsolve_program import EXTRA_ORDER, formula
from benchmarks.programs.ngsolve_program import versions as ngsolve_versions
from benchmarks.record import Answer, Configuration, Laps

ng.ngsglobals.msg_level = 0

GHOST = 0.1
NITSCHE = 10.0
"""Factors of the ghost penalty and of Nitsche's penalty."""

MARGIN = 0.05
"""What the background mesh of a ball is larger than the ball."""

COARSEST = {"annulus, sine": 0.08, "annulus": 0.08, "plate with three holes": 0.25, "Kirsch plate": 0.5}


def series(problem: Problem) -> Mapping[str, list[Configuration]]:
    """Finer background meshes at every degree."""
    if problem.dimension == 3:
        return {f"p={p}": refined("size", 0.4, 1.5, 8, degree=p) for p in (3, 2)}
    if problem.name not in COARSEST:
        return {}
    return {f"p={p}": refined("size", COARSEST[problem.name], 1.6, 9, degree=p) for p in (4, 3, 5, 2)}


def level(solid: Solid) -> Any:
    """Negative inside a ball or a bore."""
    center = solid.center if isinstance(solid, Ball) else (0.0, 0.0)
    assert isinstance(solid, Ball | Bore)
    squares = [(x - c) ** 2 for x, c in zip((ng.x, ng.y, ng.z), center, strict=False)]
    return sum(squares[1:], squares[0]) - solid.radius**2


def background(outer: Solid, size: float) -> Any:
    """Structured simplices on the bounding box of the outer solid."""
    if isinstance(outer, Block):
        low, high = outer.low, outer.high
    else:
        assert isinstance(outer, Ball)
        low = tuple(c - outer.radius - MARGIN for c in outer.center)
        high = tuple(c + outer.radius + MARGIN for c in outer.center)
    n = ceil((high[0] - low[0]) / size)
    place = lambda *unit: tuple(a + (b - a) * t for a, b, t in zip(low, high, unit, strict=True))  # noqa: E731
    if len(low) == 2:
        return MakeStructured2DMesh(quads=False, nx=n, ny=n, mapping=place)
    return MakeStructured3DMesh(hexes=False, nx=n, ny=n, nz=n, mapping=place)


class Cut:
    """Background mesh, one level set followed to order `degree`, and the measures over what it cuts out."""

    def __init__(self, problem: Problem, size: float, degree: int) -> None:
        self.mesh = mesh = background(problem.outer, size)
        self.degree = degree
        holes = reduce(lambda a, b: a * b, [level(hole) for hole in problem.holes])
        whole = -holes if isinstance(problem.outer, Block) else level(problem.outer) * holes
        adaptation = LevelSetMeshAdaptation(mesh, order=degree, threshold=0.5, discontinuous_qn=True)
        self.deformation = adaptation.CalcDeformation(whole)
        self.level = adaptation.lset_p1
        info = CutInfo(mesh, self.level)
        self.active, cut = info.GetElementsOfType(HASNEG), info.GetElementsOfType(IF)
        deformed = {"deformation": self.deformation}
        self.inside = dCut(self.level, NEG, definedonelements=self.active, order=2 * degree + 1, **deformed)
        self.edge = dCut(self.level, IF, definedonelements=cut, order=2 * degree + 1, **deformed)
        facets = GetFacetsWithNeighborTypes(mesh, a=self.active, b=cut)
        self.patches = dFacetPatch(definedonelements=facets, **deformed)
        self.normal = ng.Normalize(ng.grad(self.level))

    def space(self, kind: Any, **sides: str) -> Any:
        """Finite elements that reach into the domain."""
        space = kind(self.mesh, order=self.degree, dgjumps=True, **sides)
        return ng.Compress(space, GetDofsOfElements(space, self.active))

    def error(self, field: Any, exact: Any) -> float:
        """Relative error over the deformed cut mesh."""
        where = dCut(
            self.level, NEG, definedonelements=self.active, order=2 * self.degree + EXTRA_ORDER,
            deformation=self.deformation,
        )  # fmt: skip
        return relative(self.mesh, where, field, exact)


def relative(mesh: Any, where: Any, field: Any, exact: Any) -> float:
    """Relative error under a measure."""
    norm = lambda value: ng.Integrate(ng.InnerProduct(value, value) * where, mesh) ** 0.5  # noqa: E731
    return float(norm(field - exact) / norm(exact))


def ghost(u: Any, v: Any, patches: Any) -> Any:
    """Direct ghost penalty."""
    jump = lambda one: one - one.Other()  # noqa: E731
    return GHOST / ng.specialcf.mesh_size**2 * ng.InnerProduct(jump(u), jump(v)) * patches


def finish(form: Any, load: Any, field: Any, laps: Laps) -> None:
    """Assemble and solve."""
    form.Assemble()
    load.Assemble()
    residual = (load.vec - form.mat * field.vec).Evaluate()
    laps.lap("assembly")
    field.vec.data += form.mat.Inverse(field.space.FreeDofs(), inverse="sparsecholesky") * residual
    laps.lap("solve")


def _poisson(problem: Problem, cut: Cut, laps: Laps) -> tuple[Any, Any]:
    sides = {"dirichlet": ".*"} if isinstance(problem.outer, Block) else {}
    space = cut.space(ng.H1, **sides)
    u, v = space.TnT()
    n, penalty = cut.normal, NITSCHE * cut.degree**2 / ng.specialcf.mesh_size
    form = ng.BilinearForm(space, symmetric=True)
    form += ng.grad(u) * ng.grad(v) * cut.inside + ghost(u, v, cut.patches)
    form += (-ng.grad(u) * n * v - ng.grad(v) * n * u + penalty * u * v) * cut.edge
    load = ng.LinearForm(space)
    load += formula(problem, "source") * v * cut.inside
    field = ng.GridFunction(space)
    if problem.data is not None:
        data = formula(problem, "data")
        load += (-ng.grad(v) * n * data + penalty * data * v) * cut.edge
        field.Set(data, definedon=cut.mesh.Boundaries(".*"))
    finish(form, load, field, laps)
    return space, field


def _elasticity(problem: Problem, cut: Cut, laps: Laps) -> tuple[Any, Any]:
    # one space a component: a compressed vector space forgets conditions on single components
    space = cut.space(ng.H1, dirichlet="left") * cut.space(ng.H1, dirichlet="bottom")
    trial, test = space.TnT()
    strain, other = (ng.Sym(ng.CF((ng.grad(a), ng.grad(b)), dims=(2, 2))) for a, b in (trial, test))
    energy = LAMBDA * ng.Trace(strain) * ng.Trace(other) + 2 * MU * ng.InnerProduct(strain, other)
    form = ng.BilinearForm(space, symmetric=True)
    form += energy * cut.inside
    for u, v in zip(trial, test, strict=True):
        form += ghost(u, v, cut.patches)
    xx, yy, xy = kirsch_stress(None, ng.x, ng.y)
    load = ng.LinearForm(space)
    load += (xx * test[0] + xy * test[1]) * ng.ds("right", bonus_intorder=4)
    load += (xy * test[0] + yy * test[1]) * ng.ds("top", bonus_intorder=4)
    field = ng.GridFunction(space)
    finish(form, load, field, laps)
    return space, ng.CF(tuple(field.components))


EQUATIONS = {"poisson": _poisson, "elasticity": _elasticity}


def solve(problem: Problem, configuration: Configuration, laps: Laps) -> Answer:
    """Cut, assemble and solve once."""
    degree, size = configuration["degree"], configuration["size"]
    if problem.dimension == 3:
        return _with_edges(problem, size, degree, laps)
    cut = Cut(problem, size, degree)
    laps.lap("geometry")
    space, field = EQUATIONS[problem.equation](problem, cut, laps)
    exact = formula(problem, "exact")
    return Answer(space.ndof, lambda: cut.error(field, exact))


def _with_edges(problem: Problem, size: float, degree: int, laps: Laps) -> Answer:
    """Poisson's equation on the intersection of two piecewise linear level sets."""
    mesh = background(problem.outer, size)
    linear = ng.H1(mesh, order=1)
    levels = (ng.GridFunction(linear), ng.GridFunction(linear))
    for one, formula_of in zip(levels, (level(problem.outer), -level(problem.holes[0])), strict=True):
        InterpolateToP1(formula_of, one)
    domain = DomainTypeArray((NEG, NEG))
    domain.Compress(levels)
    boundary = domain.Boundary()
    boundary.Compress(levels)
    info = MultiLevelsetCutInfo(mesh, levels)
    active = ng.BitArray(info.GetElementsWithContribution(domain))
    cut = ng.BitArray(info.GetElementsWithContribution(boundary))
    inside = dCut(levels, domain, definedonelements=active, order=2 * degree)
    facets = GetFacetsWithNeighborTypes(mesh, a=active, b=cut, use_and=True)
    laps.lap("geometry")
    space = ng.H1(mesh, order=degree, dgjumps=True)
    space = ng.Compress(space, GetDofsOfElements(space, active))
    u, v = space.TnT()
    data, penalty = formula(problem, "data"), NITSCHE * degree**2 / ng.specialcf.mesh_size
    form = ng.BilinearForm(space, symmetric=True)
    form += ng.grad(u) * ng.grad(v) * inside + ghost(u, v, dFacetPatch(definedonelements=facets))
    load = ng.LinearForm(space)
    load += formula(problem, "source") * v * inside
    for part, n in domain.GetOuterNormals(levels).items():
        met = ng.BitArray(info.GetElementsWithContribution(part))
        face = dCut(levels, part, definedonelements=met, order=2 * degree)
        form += (-ng.grad(u) * n * v - ng.grad(v) * n * u + penalty * u * v) * face
        load += (-ng.grad(v) * n * data + penalty * data * v) * face
    field = ng.GridFunction(space)
    finish(form, load, field, laps)
    exact = formula(problem, "exact")
    where = dCut(levels, domain, definedonelements=active, order=2 * degree + 3)
    return Answer(space.ndof, lambda: relative(mesh, where, field, exact))


def versions() -> Mapping[str, str]:
    """Versions of what ran."""
    return {**ngsolve_versions(), "xfem": version("xfem"), "python": platform.python_version()}
