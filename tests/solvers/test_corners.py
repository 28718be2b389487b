"""Singular functions at corners: errors and orders, exact conditions, quadrature, refusals."""

from dataclasses import replace

import numpy as np
import pytest

from rfm.calculus import functions as fn
from rfm.errors import DiscretizationError
from rfm.geometry import disk, half_plane, polygon, rectangle
from rfm.geometry.singular.straight import straight_corners
from solvers import pipeline, ritz
from solvers.background import background_grid
from solvers.corners.enrichment import enriched_corners
from solvers.corners.rules import fan
from solvers.equations.poisson import Poisson
from solvers.grid import Grid
from solvers.least_squares import LeastSquares
from solvers.measures import measure
from solvers.norms import all_boundary_errors, error_norms
from solvers.problem import Dirichlet, Discretization, Neumann, Problem, SolverOptions

L_SHAPE = ((0, 0), (1, 0), (1, 1), (-1, 1), (-1, -1), (0, -1))


def sector(vertices, held=(True, True), coefficients=(1.0, -0.6, 0.2, 0.3)):
    """A harmonic function of several exponents at the corner (0, 0) of a polygon in [-1, 1]^2, with given data.

    Edges of the corner: the first and the last.  The data of the square's sides are extended smoothly to zero there.
    """
    domain = polygon(vertices)
    (corner,) = straight_corners(domain)
    start, angle = corner.start, corner.angle
    shift = 0.0 if held[0] == held[1] else 0.5
    c, s = float(np.cos(start + 0.5 * angle)), float(np.sin(start + 0.5 * angle))

    def exact(x, y):
        u, v = c * x + s * y, c * y - s * x
        theta, r = fn.atan2(v, u) + 0.5 * angle, fn.sqrt(x * x + y * y)
        total = 0.0
        for k, a in enumerate(coefficients, start=1):
            power = (k - shift) * np.pi / angle
            wave = fn.sin(power * theta) if held[0] else fn.cos(power * theta)
            total = total + a * r**power * wave
        return total

    def data(x, y):
        inner = (1 - x * x) * (1 - y * y)
        return exact(x, y) * (1 - inner) ** 3 * fn.exp(inner * (0.7 * x - 0.4 * y))

    own = [
        domain.part(f"edge{0 if surface is corner.first else len(vertices) - 1}")
        for surface in (corner.first, corner.second)
    ]
    free = [part for part, yes in zip(own, held, strict=True) if not yes]
    rest = domain.part("all")
    for part in free:
        rest = rest - part
    conditions = (Dirichlet(rest, data), *(Neumann(part, 0.0) for part in free))
    return Problem(domain, Poisson(), conditions, exact), corner


def error(problem, degree, grid, **options):
    solution = ritz.solve(problem, Discretization(degree=degree, grid=grid, **options))
    (piece,) = solution.pieces
    return error_norms(piece.trial, problem.exact, piece.background).l2, solution


@pytest.mark.parametrize(("degree", "grids"), [(2, (24, 32)), (3, (24, 32)), (4, (18, 24))])
def test_orders_on_the_l_shape(degree, grids):
    problem, _ = sector(L_SHAPE)
    errors = [error(problem, degree, n)[0] for n in grids]
    order = np.log(errors[0] / errors[1]) / np.log(4 / 3)
    assert order == pytest.approx(degree + 1, abs=0.2), errors
    assert errors[1] < 5e-2 * error(problem, degree, grids[1], singular="none")[0]


@pytest.mark.parametrize(
    ("vertices", "held", "limit"),
    [
        (L_SHAPE, (True, True), 8e-6),
        (L_SHAPE, (True, False), 8e-6),
        (L_SHAPE, (False, True), 8e-6),
        (L_SHAPE, (False, False), 8e-6),
        (((0, 0), (1, 0.5), (1, 1), (-1, 1), (-1, -1), (1, -1), (1, -0.5)), (True, True), 2e-5),
        (((0, 0), (1, 0.1), (1, 1), (-1, 1), (-1, -1), (1, -1), (1, -0.1)), (True, True), 1e-4),
        (((0, 0), (1, 1), (-1, 1), (-1, -1), (1, -1), (1, -0.5)), (True, False), 2e-5),
    ],
)
def test_corners_of_other_angles_and_conditions(vertices, held, limit):
    problem, corner = sector(vertices, held)
    found, solution = error(problem, 5, 10)
    assert found < limit
    assert found < 2e-2 * error(problem, 5, 10, singular="none")[0]
    (leading,) = solution.intensities
    assert leading["intensity"] == pytest.approx(1.0, abs=5e-3)
    assert leading["angle"] == pytest.approx(np.degrees(corner.angle))
    conditions = problem.conditions
    assert all_boundary_errors(solution.pieces)[conditions[0].part.name] < 1e-12


def test_a_sector_of_a_disk():
    # 300 degrees, u = 0 on the radii and sin(3 theta/5) on the arc
    wedge = half_plane(point=(0, 0), normal=(-0.5, 3**0.5 / 2)) | half_plane(
        point=(0, 0), normal=(-0.5, -(3**0.5) / 2)
    )
    domain = disk(center=(0, 0), radius=1) & wedge
    power = 0.6

    def exact(x, y):
        return (x * x + y * y) ** (power / 2) * fn.sin(power * (fn.atan2(-y, -x) + 5 * np.pi / 6))

    problem = Problem(
        domain,
        Poisson(),
        (Dirichlet(domain.part("all"), lambda x, y: exact(x, y) * (x * x + y * y) ** 2),),
        exact,
    )
    found, solution = error(problem, 5, 10)
    assert found < 1e-5
    assert found < 1e-2 * error(problem, 5, 10, singular="none")[0]
    (leading,) = solution.intensities
    assert leading["exponent"] == pytest.approx(0.6)
    assert leading["intensity"] == pytest.approx(1.0, abs=1e-3)
    assert max(all_boundary_errors(solution.pieces).values()) < 1e-12


def test_many_corners_are_left_alone():
    teeth = [(x, y) for k in range(10) for x, y in ((k, 1.0), (k + 0.5, 0.5))]
    comb = polygon([*teeth, (10, 1), (10, -1), (0, -1)])
    problem = Problem(comb, Poisson(source=1.0), (Dirichlet(comb.part("all")),))
    assert len(straight_corners(comb)) == 10
    for singular, count in (("auto", 0), ("corners", 10)):
        chosen = Discretization(degree=2, grid=80, singular=singular)
        assert len(enriched_corners(problem, chosen, background_grid(comb, chosen))) == count


def test_values_are_exact_on_all_of_the_boundary():
    problem, _ = sector(L_SHAPE)
    _, solution = error(problem, 3, 8)
    t = np.linspace(0, 1, 41)[:, None]
    for a, b in zip(np.array(L_SHAPE), np.roll(L_SHAPE, -1, axis=0), strict=True):
        points = (1 - t) * a + t * b
        assert np.abs(solution.u(points) - problem.exact(*points.T)).max() < 1e-12


def test_a_source_needs_the_logarithms():
    # the integral of u is 0.2140758027: NGSolve, degree 12, 14 levels of geometric refinement towards all corners
    domain = polygon(L_SHAPE)
    problem = Problem(domain, Poisson(source=1.0), (Dirichlet(domain.part("all")),))
    found = [
        -2 * measure(ritz.solve(problem, Discretization(degree=4, grid=12, singular=s)).pieces).energy
        for s in ("auto", "none")
    ]
    assert found[0] == pytest.approx(0.2140758027, abs=3e-8)
    assert abs(found[1] - 0.2140758) > 1e-4


def test_the_benchmark():
    # data of regularity r^(8/3); a finite element program takes 4100 unknowns for 1e-6 and 21000 for 1e-8
    from types import SimpleNamespace

    from benchmarks.problems import problem as stated

    ell = stated("L-shape")
    maths = SimpleNamespace(sin=fn.sin, arctan2=fn.atan2)
    domain = polygon(ell.outer.vertices)
    data = lambda x, y: ell.data(maths, x, y)  # noqa: E731
    problem = Problem(
        domain, Poisson(), (Dirichlet(domain.part("all"), data),), lambda x, y: ell.exact(maths, x, y)
    )
    found, solution = error(problem, 4, 6)
    assert found < 1e-6
    assert solution.dofs < 4100 / 8
    found, solution = error(problem, 8, 10)
    assert found < 1e-8
    assert solution.dofs < 21000 / 8


def test_a_reaction_has_products_with_the_squared_radius():
    # u = I_lambda(r sqrt c) sin(lambda theta) by its series, of which r^lambda (1 + c r^2/(4 (lambda + 1))) leads
    plain, _ = sector(L_SHAPE, coefficients=(1.0,))
    power, c = 2 / 3, 6.0

    def exact(x, y):
        r2 = 0.25 * c * (x * x + y * y)
        total, term = 1.0, 1.0
        for j in range(1, 16):
            term = term * r2 * (1 / (j * (power + j)))
            total = total + term
        return plain.exact(x, y) * total

    def data(x, y):
        inner = (1 - x * x) * (1 - y * y)
        return exact(x, y) * (1 - inner) ** 3

    problem = replace(
        plain,
        equation=Poisson(reaction=c),
        conditions=(Dirichlet(plain.domain.part("all"), data),),
        exact=exact,
    )
    found, solution = error(problem, 5, 12)
    assert found < 2e-6
    assert solution.intensities[0]["intensity"] == pytest.approx(1.0, abs=1e-4)


def test_the_corners_of_a_hole():
    # the integral of u: NGSolve, degree 10, 10 levels of geometric refinement towards all corners; the intensity: from
    # its values on the bisector at a distance of 1e-3 and 1e-4
    domain = rectangle(min=(-1, -1), max=(1, 1)) - rectangle(min=(-0.5, -0.5), max=(0.5, 0.5))
    problem = Problem(domain, Poisson(source=1.0), (Dirichlet(domain.part("all")),))
    solution = ritz.solve(problem, Discretization(degree=4, grid=16))
    assert [one["intensity"] for one in solution.intensities] == pytest.approx([0.16612] * 4, rel=0.03)
    assert max(all_boundary_errors(solution.pieces).values()) < 1e-12
    assert -2 * measure(solution.pieces).energy == pytest.approx(0.0670321268, abs=2e-7)
    plain = ritz.solve(problem, Discretization(degree=4, grid=16, singular="none"))
    assert -2 * measure(plain.pieces).energy < 0.06703212 - 1e-4


def test_windows_where_other_boundary_lies_on_the_line_of_an_edge():
    cross = rectangle(min=(-1, -0.4), max=(1, 0.4)) | rectangle(min=(-0.4, -1), max=(0.4, 1))
    problem = Problem(cross, Poisson(source=1.0), (Dirichlet(cross.part("all")),))
    solution, plain, fine = (
        ritz.solve(problem, Discretization(degree=3, grid=n, singular=s))
        for n, s in ((20, "auto"), (20, "none"), (60, "auto"))
    )
    assert len(solution.intensities) == 4
    assert max(all_boundary_errors(solution.pieces).values()) < 1e-12
    energies = [measure(one.pieces).energy for one in (solution, plain, fine)]
    assert energies[2] < energies[0] < energies[1]
    assert energies[0] - energies[2] < 0.2 * (energies[1] - energies[2])


@pytest.mark.parametrize("cells", [(4, 4), (5, 5), (5, 4)])
def test_the_fan_integrates_singular_products(cells):
    # over the L-shaped middle of [-1, 1]^2: areas, and r^(-2/3), against a fine subdivision in closed form
    corner = straight_corners(polygon(L_SHAPE))[0]
    counts = np.array(cells)
    grid = Grid(np.array([-1.0, -1.0]), 2.0 / counts, counts)
    rule = fan(grid, np.argwhere(np.ones(cells)), corner, 4)
    x, y = rule.points(grid)
    assert rule.weights.sum() == pytest.approx(3.0, rel=1e-12)
    power = float(np.sum(rule.weights * (x * x + y * y) ** (-1 / 3)))
    t, w = np.polynomial.legendre.leggauss(40)
    angle = np.pi / 8 * (t + 1)
    expected = 6 * np.sum(np.pi / 8 * w * (1 / np.cos(angle)) ** (4 / 3)) * 3 / 4
    assert power == pytest.approx(expected, rel=1e-10)


def test_nothing_changes_without_reentrant_corners():
    for domain in (
        rectangle(min=(0, 0), max=(1, 1)),
        disk(center=(0, 0), radius=1) - disk(center=(0, 0), radius=0.4),
    ):
        problem = Problem(domain, Poisson(source=1.0), (Dirichlet(domain.part("all")),))
        one, other = (
            ritz.solve(problem, Discretization(degree=3, grid=8, singular=s)).linear.x
            for s in ("auto", "none")
        )
        assert (one == other).all()


def test_other_methods_leave_corners_as_they_are():
    problem, _ = sector(L_SHAPE)
    solution = pipeline.solve(problem, Discretization(degree=3, grid=8), LeastSquares())
    assert solution.intensities == ()
    assert len(solution.trial.splines) == 1


def test_refusals():
    problem, _ = sector(L_SHAPE)
    asked = Discretization(degree=3, grid=8, singular="corners")
    with pytest.raises(
        DiscretizationError,
        match=r"^singular functions at corners are not available here: "
        r"the method must be ritz without a device; use singular: auto$",
    ):
        pipeline.solve(problem, asked, LeastSquares())
    with pytest.raises(
        DiscretizationError,
        match=r"the equation must be poisson with a constant conductivity and no advection",
    ):
        ritz.solve(replace(problem, equation=Poisson(conductivity=lambda x, y: 1 + x * x)), asked)
    domain = rectangle(min=(0, 0), max=(1, 1))
    convex = Problem(domain, Poisson(source=1.0), (Dirichlet(domain.part("all")),))
    with pytest.raises(
        DiscretizationError,
        match=r"^singular must be auto or none here: the domain has no corner above 180 degrees",
    ):
        ritz.solve(convex, asked)
    with pytest.raises(
        DiscretizationError, match=r"^unknown singular 'all': choose one of auto, none, corners$"
    ):
        ritz.solve(problem, replace(asked, singular="all"))
    with pytest.raises(DiscretizationError, match="the linear solver must not be multigrid"):
        ritz.solve(problem, asked, SolverOptions(linear="multigrid"))
    piece = replace(convex, conditions=(Dirichlet(domain.part("all").restricted(lambda x, y: x - 0.5)),))
    with pytest.raises(DiscretizationError, match="every condition must hold on whole surfaces"):
        ritz.solve(piece, asked)
    with pytest.raises(DiscretizationError, match="a value must be prescribed somewhere"):
        ritz.solve(
            Problem(problem.domain, Poisson(reaction=1.0), (Neumann(problem.domain.part("all")),)), asked
        )


@pytest.mark.parametrize("linear", ["dense", "superlu", "cg"])
def test_every_linear_solver_serves_the_splines(linear):
    problem, _ = sector(L_SHAPE)
    expected = error(problem, 3, 8)[0]
    solution = ritz.solve(problem, Discretization(degree=3, grid=8), SolverOptions(linear=linear))
    (piece,) = solution.pieces
    assert error_norms(piece.trial, problem.exact, piece.background).l2 == pytest.approx(expected, rel=1e-3)
