"""The bases of psi: tables, assembly, evaluation, storage; what holds of each and of all."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.polynomial import chebyshev, legendre

from rfm.calculus.jets import multi_indices
from rfm.errors import DiscretizationError, NumericsError
from rfm.geometry import ball, disk
from solvers.background import prepare
from solvers.bases import tensor_assembly
from solvers.bases.dense_assembly import DenseAssembler
from solvers.bases.lines import CHEBYSHEV_LINE, LEGENDRE_LINE, Trigonometric
from solvers.bases.registry import BASES, basis
from solvers.bases.resolution import folded_points, gauss_points, polynomial_growth
from solvers.bases.wendland import derivatives
from solvers.linear import solve as solve_linear
from solvers.linear.nonsymmetric import solve as solve_nonsymmetric
from solvers.problem import Discretization
from solvers.quadrature.batch import PointBatch, TensorBatch
from solvers.quadrature.pieces import gauss
from solvers.stopwatch import Stopwatch

DEGREE = {"web-spline": 3, "b-spline": 3, "chebyshev": 5, "legendre": 5, "trigonometric": 2, "radial": 2}
GLOBAL = [name for name, one in BASES.items() if not one.local]
ELLIPSE = disk(center=(0.3, 0.2), radius=0.5).named("disk")
BALL = ball(center=(0, 0, 0), radius=1).named("ball")
RNG = np.random.default_rng(5)


def background(name, domain=ELLIPSE, grid=6, degree=None):
    return prepare(
        domain, Discretization(degree=degree or DEGREE[name], grid=grid, basis=name), Stopwatch(None)
    )


def batches(back):
    """The same points as a tensor batch and as a point batch."""
    tensor = back.rules.inner
    unit = np.broadcast_to(tensor.unit_points(), (*tensor.weights.shape, back.grid.dimension))
    return tensor, PointBatch(tensor.cells, unit, tensor.weights)


@pytest.mark.parametrize(
    ("line", "module", "scale"),
    [
        (CHEBYSHEV_LINE, chebyshev.Chebyshev, lambda k: 1.0),
        (LEGENDRE_LINE, legendre.Legendre, lambda k: (2 * k + 1) ** 0.5),
    ],
    ids=["chebyshev", "legendre"],
)
def test_polynomials_and_their_derivatives(line, module, scale):
    t = np.linspace(0, 1, 23)
    table = line.table(12, t, 3)
    for k in range(13):
        for r in range(4):
            expected = scale(k) * 2.0**r * module.basis(k).deriv(r)(2 * t - 1)
            assert np.allclose(table[r, :, k], expected, rtol=1e-10, atol=1e-10 * np.abs(expected).max())


def test_trigonometric_functions_and_their_derivatives():
    t, step = np.linspace(0.05, 0.95, 11), 1e-4
    line = Trigonometric()
    table = line.table(4, t, 3)
    for r in range(3):
        slope = (line.table(4, t + step, r)[r] - line.table(4, t - step, r)[r]) / (2 * step)
        assert np.allclose(slope, table[r + 1], atol=1e-4 * np.abs(table[r + 1]).max())
    period = line.table(4, t + line.period, 0)
    assert np.allclose(period, table[0])


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("smoothness", [1, 2, 3])
def test_radial_functions_and_their_derivatives(dimension, smoothness):
    where, step, radius = RNG.uniform(-0.5, 0.5, (20, dimension)), 1e-5, 0.8
    table = derivatives(where, radius, smoothness, smoothness)
    alphas = multi_indices(dimension, smoothness)
    for k, alpha in enumerate(alphas):
        if not any(alpha):
            continue
        axis = next(i for i, a in enumerate(alpha) if a)
        lower = alphas.index(tuple(a - (i == axis) for i, a in enumerate(alpha)))
        shift = step * np.eye(dimension)[axis]
        above, below = (
            derivatives(where + s * shift, radius, smoothness, smoothness)[lower] for s in (1, -1)
        )
        assert np.allclose((above - below) / (2 * step), table[k], atol=1e-6 * np.abs(table[k]).max())


def test_radial_functions_are_smooth_at_the_end_of_their_support():
    edge = np.array([[0.8 - 1e-6, 0.0], [0.8, 0.0], [2.0, 0.0]])
    assert np.abs(derivatives(edge, 0.8, 2, 2)).max() < 1e-9
    assert derivatives(np.zeros((1, 3)), 0.8, 3, 0)[0, 0] == pytest.approx(1.0)


@pytest.mark.parametrize("cells", [1, 4, 8])
@pytest.mark.parametrize("degree", [6, 20, 40])
def test_products_are_integrated_and_interpolated(degree, cells):
    """In an end cell, where polynomials of the box oscillate fastest."""
    growth = polynomial_growth(2 * degree, cells)
    fine, weights = gauss(80)
    many = LEGENDRE_LINE.table(degree, fine / cells, 0)[0]
    reference = many.T @ (weights[:, None] * many)
    nodes, few = gauss(min(gauss_points(growth), degree + 3))
    table = LEGENDRE_LINE.table(degree, nodes / cells, 0)[0]
    assert np.allclose(table.T @ (few[:, None] * table), reference, atol=1e-12 * np.abs(many).max() ** 2)
    assert folded_points(growth) > gauss_points(growth)


@pytest.mark.parametrize("name", BASES)
def test_a_space_holds_the_constants(name):
    back = background(name)
    for batch in batches(back):
        jet = back.space.function(back.space.constant).jet(batch, 1)
        assert np.allclose(jet[0], 1.0)
        assert np.allclose(jet[1:], 0.0, atol=1e-12)
    function = back.space.function(RNG.standard_normal(back.space.n_dofs))
    raised = function.plus(2.5)
    assert np.allclose(raised.jet(batch, 0), function.jet(batch, 0) + 2.5)


@pytest.mark.parametrize("name", BASES)
def test_a_space_knows_its_affine_functions(name):
    back = background(name)
    slope = np.array([2.0, -3.0])
    unknowns = back.space.affine(0.5, slope)
    assert (unknowns is None) == (name in ("trigonometric", "radial"))
    assert np.array_equal(back.space.affine(0.5, 0 * slope), 0.5 * back.space.constant)
    if unknowns is not None:
        x, y = back.rules.inner.points(back.grid)
        jet = back.space.function(unknowns).jet(back.rules.inner, 1)
        assert np.allclose(jet[0], 0.5 + 2 * x - 3 * y)
        assert np.allclose(jet[1:], slope[:, None, None])


@pytest.mark.parametrize("name", BASES)
@pytest.mark.parametrize("domain", [ELLIPSE, BALL], ids=["plane", "space"])
def test_derivatives_are_those_of_the_function(name, domain):
    """Against differences of values, at scattered points; and on tensor nodes the same."""
    back = background(name, domain, 4)
    function = back.space.function(RNG.standard_normal(back.space.n_dofs))
    tensor, points = batches(back)
    order = 2 if name != "b-spline" else 1
    jet = function.jet(points, order)
    assert np.allclose(
        function.jet(tensor, order), jet, atol=1e-9 * np.abs(jet).max(axis=(1, 2), keepdims=True)
    )
    step = 1e-6
    for axis in range(domain.dimension):
        shift = step * np.eye(domain.dimension)[axis]
        ahead, behind = (
            function.jet(PointBatch(points.cells, points.nodes + s * shift, points.weights), 0)[0]
            for s in (1, -1)
        )
        slope = (ahead - behind) / (2 * step * back.grid.spacing[axis])
        assert np.allclose(slope, jet[1 + axis], atol=2e-6 * np.abs(jet[1 + axis]).max())


def test_scattered_evaluation_is_done_in_chunks(monkeypatch):
    back = background("legendre")
    function = back.space.function(RNG.standard_normal(back.space.n_dofs))
    whole = [function.jet(batch, 2) for batch in batches(back)]
    monkeypatch.setattr("solvers.bases.tensor.WORK", 100)
    for batch, expected in zip(batches(back), whole, strict=True):
        assert np.allclose(function.jet(batch, 2), expected)


@pytest.mark.parametrize("name", GLOBAL)
@pytest.mark.parametrize("domain", [ELLIPSE, BALL], ids=["plane", "space"])
@pytest.mark.parametrize("symmetric", [True, False])
def test_the_matrix_is_the_sum_over_the_points(name, domain, symmetric, monkeypatch):
    back = background(name, domain, 3, degree=1 if domain is BALL else None)
    monkeypatch.setattr(tensor_assembly, "NODES", 300)
    monkeypatch.setattr("solvers.bases.dense_assembly.WORK", 20_000)
    tensor, points = batches(back)
    size = len(multi_indices(domain.dimension, 1))
    keys = [(a, b) for a in range(size) for b in range(size) if a <= b or not symmetric]
    blocks = {key: RNG.standard_normal(tensor.weights.shape) for key in keys}
    loads = {alpha: RNG.standard_normal(tensor.weights.shape) for alpha in range(size)}
    table = back.space.table(points.cells, points.nodes, 1)
    expected = sum(table[a].T @ (c.ravel()[:, None] * table[b]) for (a, b), c in blocks.items())
    if symmetric:
        expected = expected + sum(
            table[b].T @ (c.ravel()[:, None] * table[a]) for (a, b), c in blocks.items() if a != b
        )
    right = sum(c.ravel() @ table[a] for a, c in loads.items())
    for batch in (tensor, points):
        assembler = back.space.assembler(symmetric)
        assembler.add(batch, blocks, loads)
        matrix, load = assembler.finish()
        assert np.allclose(matrix, expected, atol=1e-10 * np.abs(expected).max())
        assert np.allclose(load, right, atol=1e-10 * np.abs(right).max())


def test_an_empty_batch_adds_nothing():
    back = background("chebyshev")
    for empty in (back.rules.inner.take(slice(0, 0)), batches(back)[1].take(slice(0, 0))):
        for assembler in (back.space.assembler(), DenseAssembler(back.space)):
            assembler.add(empty, {(0, 0): np.zeros(empty.weights.shape)}, {0: np.zeros(empty.weights.shape)})
            matrix, load = assembler.finish()
            assert not matrix.any()
            assert not load.any()
    assert isinstance(empty, PointBatch)
    assert isinstance(back.rules.inner, TensorBatch)


@pytest.mark.parametrize("name", BASES)
def test_a_stored_function_is_the_same_again(name):
    back = background(name)
    function = back.space.function(RNG.standard_normal(back.space.n_dofs))
    loaded = basis(name).load(function.grid, function.degree, np.array(function.coefficients))
    for batch in batches(back):
        assert np.array_equal(loaded.jet(batch, 1), function.jet(batch, 1))
    with pytest.raises(DiscretizationError, match="shape"):
        basis(name).load(function.grid, function.degree + 1, function.coefficients)


@pytest.mark.parametrize("name", BASES)
def test_a_degree_out_of_range_is_refused_by_name(name):
    for wrong in (0, basis(name).degrees[1] + 1):
        with pytest.raises(
            DiscretizationError,
            match=f"between 1 and {basis(name).degrees[1]} for basis: {name}, got {wrong}",
        ):
            prepare(ELLIPSE, Discretization(degree=wrong, grid=4, basis=name), Stopwatch(None))


def test_an_unknown_basis_is_refused_with_the_nearest():
    with pytest.raises(DiscretizationError, match="did you mean 'chebyshev'"):
        basis("chebychev")
    with pytest.raises(DiscretizationError, match="the bases are: web-spline, "):
        basis("x")


def test_too_many_unknowns_for_a_dense_matrix_are_refused():
    with pytest.raises(DiscretizationError, match="at most degree 19, or basis: web-spline"):
        background("legendre", BALL, 2, degree=25)
    with pytest.raises(DiscretizationError, match="coarser grid, or basis: web-spline"):
        background("radial", ELLIPSE, 80, degree=1)


def test_radial_functions_have_no_more_derivatives_than_their_degree():
    back = background("radial", degree=1)
    with pytest.raises(DiscretizationError, match="take degree 2 or basis: web-spline"):
        back.space.function(back.space.constant).jet(back.rules.inner, 2)


def test_pivoting_leaves_out_what_depends_on_the_rest():
    factor = RNG.standard_normal((12, 7))
    matrix, x = factor @ factor.T, RNG.standard_normal(12)
    found = solve_linear(matrix, matrix @ x, method="pivoted")
    assert np.count_nonzero(found.x) == 7
    assert np.allclose(matrix @ found.x, matrix @ x)
    tilted = factor @ RNG.standard_normal((7, 12))
    found = solve_nonsymmetric(tilted, tilted @ x, method="pivoted")
    assert np.count_nonzero(found.x) == 7
    assert np.allclose(tilted @ found.x, tilted @ x)


def test_pivoting_does_not_hide_negative_energy():
    matrix = np.eye(4)
    matrix[0, 1] = matrix[1, 0] = 1.5
    with pytest.raises(NumericsError, match="not positive definite"):
        solve_linear(matrix, np.ones(4), method="pivoted")
