"""Linear solvers: they agree, report what they reached, and refuse what has no unique solution."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.sparse import csr_array, diags_array, eye_array, kron

from rfm.errors import NumericsError
from solvers.assembly import Assembler
from solvers.linear import METHODS, solve
from solvers.linear.choice import choose
from solvers.linear.direct import Pardiso
from solvers.linear.relaxation import OMEGA, Split
from solvers.linear.system import ScaledSystem
from solvers.web import SplineSpace
from tests.solvers.synthetic import full_states, gauss_batch, to_array, unit_grid

ALWAYS = sorted(set(METHODS) - {"pardiso", "multigrid"})
"""Methods for any matrix; multigrid needs a grid (test_multigrid)."""


def laplacian(n, shift=0.0):
    """Five-point Laplacian on n x n points."""
    line = diags_array([-np.ones(n - 1), 2 * np.ones(n), -np.ones(n - 1)], offsets=[-1, 0, 1])
    return csr_array(kron(line, eye_array(n)) + kron(eye_array(n), line) + shift * eye_array(n * n))


def neumann(n, degree=2):
    """Pure Neumann Laplacian of a box, and its load for a source with mean zero."""
    return neumann_assembler(n, degree).finish()


def neumann_assembler(n, degree):
    """Assembler of both."""
    grid = unit_grid(n, n)
    space = SplineSpace.build(grid, degree, full_states(grid))
    batch = gauss_batch(grid, np.argwhere(full_states(grid).state == 1), degree + 1)
    assembler = Assembler(space)
    x, _ = batch.points(grid)
    side = float(grid.spacing[0] * grid.cells[0])
    source = np.cos(np.pi * x / side)
    assembler.add(batch, {(1, 1): batch.weights, (2, 2): batch.weights}, {0: batch.weights * source})
    return assembler


@pytest.mark.parametrize("method", [*ALWAYS, "auto"])
@pytest.mark.parametrize("store", [csr_array, to_array])
def test_all_methods_agree(method, store):
    matrix = laplacian(20)
    exact = np.random.default_rng(0).standard_normal(400)
    found = solve(store(matrix), matrix @ exact, method, tolerance=1e-13)
    np.testing.assert_allclose(found.x, exact, atol=1e-10)
    assert found.residual < 1e-12
    assert found.method in METHODS
    assert found.reason


@given(st.integers(1, 8), st.integers(0, 10**6))
@settings(deadline=None, max_examples=30)
def test_random_definite_matrices_of_any_scale(n, seed):
    rng = np.random.default_rng(seed)
    root = rng.standard_normal((n, 2 * n)) * 10.0 ** rng.uniform(-6, 6, size=(n, 1))
    matrix = root @ root.T
    load = rng.standard_normal(n)
    found = solve(matrix, load)
    # backward stable row by row: the diagonal scaling does not see the units of the unknowns
    size = np.abs(matrix) @ np.abs(found.x) + np.abs(load)
    assert (np.abs(load - matrix @ found.x) <= 1e-10 * size * n).all()


def test_the_residual_is_the_true_one():
    matrix = laplacian(15)
    load = np.arange(225.0)
    found = solve(matrix, load, "cg", tolerance=1e-5)
    true = np.linalg.norm(load - matrix @ found.x) / np.linalg.norm(load)
    assert 0 < true <= 1e-5
    np.testing.assert_allclose(found.residual, true)
    assert found.iterations > 5


def test_a_zero_load_has_a_zero_solution():
    found = solve(laplacian(5), np.zeros(25))
    assert not found.x.any()
    assert found.residual == 0


@pytest.mark.parametrize("method", [*ALWAYS, "auto"])
def test_pure_neumann_problem(method):
    matrix, load = neumann(8)
    found = solve(matrix, load, method, null_space=np.ones(len(load)))
    np.testing.assert_allclose(found.x.sum(), 0.0, atol=1e-10 * np.abs(found.x).sum())
    np.testing.assert_allclose(to_array(matrix) @ found.x, load, atol=1e-11 * np.abs(load).max())


def test_two_null_vectors():
    block = to_array(neumann(4)[0])
    n = len(block)
    matrix = np.kron(np.eye(2), block)
    null = np.kron(np.eye(2), np.ones((n, 1)))
    load = matrix @ np.random.default_rng(0).standard_normal(2 * n)
    for method in ALWAYS:
        found = solve(csr_array(matrix), load, method, null_space=null)
        np.testing.assert_allclose(matrix @ found.x, load, atol=1e-10)
        np.testing.assert_allclose(null.T @ found.x, 0.0, atol=1e-10)


@pytest.mark.parametrize("method", ["dense", "superlu"])
def test_a_singular_matrix_is_refused(method):
    matrix, load = neumann(6)
    with pytest.raises(NumericsError, match=r"singular.*Dirichlet"):
        solve(matrix, load, method)


@pytest.mark.parametrize("method", ALWAYS)
def test_an_indefinite_matrix_is_refused(method):
    matrix = laplacian(12, shift=-1.0)
    with pytest.raises(NumericsError, match=r"not positive definite.*quadrature_points"):
        solve(matrix, np.random.default_rng(0).standard_normal(144), method)


def test_a_diagonal_that_is_not_positive_is_refused():
    matrix = to_array(laplacian(3))
    for entry, message in ((0.0, "singular"), (-1.0, "not positive definite")):
        matrix[4, 4] = entry
        with pytest.raises(NumericsError, match=message):
            solve(matrix, np.ones(9))


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_numbers_that_are_not_finite_are_refused(bad):
    load = np.ones(25)
    load[3] = bad
    with pytest.raises(NumericsError, match="load has entries that are not finite"):
        solve(laplacian(5), load)
    matrix = laplacian(5)
    matrix.data[7] = bad
    with pytest.raises(NumericsError, match="matrix has entries that are not finite"):
        solve(matrix, np.ones(25))


def test_an_unknown_method_and_shapes_that_do_not_match_are_refused():
    with pytest.raises(NumericsError, match="auto or one of amg, cg, dense"):
        solve(laplacian(3), np.ones(9), "gauss")
    with pytest.raises(NumericsError, match="load has 8 entries"):
        solve(laplacian(3), np.ones(8))
    with pytest.raises(NumericsError, match="no unknowns"):
        solve(np.zeros((0, 0)), np.zeros(0))


def test_a_missing_package_is_named(monkeypatch):
    monkeypatch.setattr("solvers.linear.direct.Pardiso.available", staticmethod(lambda: False))
    with pytest.raises(NumericsError, match="pypardiso"):
        solve(laplacian(3), np.ones(9), "pardiso")


def test_too_few_iterations_are_reported():
    hard = diags_array(np.logspace(0, 14, 300)) + laplacian(18)[:300, :300] * 1e-3
    rotation = np.linalg.qr(np.random.default_rng(0).standard_normal((300, 300)))[0]
    with pytest.raises(NumericsError, match="conjugate gradients"):
        solve(rotation @ hard.toarray() @ rotation.T, np.ones(300), "cg")


def test_automatic_choice_falls_back_to_a_factorisation():
    """A matrix on which conjugate gradients do not converge in the steps they are allowed."""
    matrix = csr_array(laplacian(60) @ laplacian(60) @ laplacian(60))
    exact = np.sin(np.arange(3600))
    found = solve(matrix, matrix @ exact)
    assert found.method in {"superlu", "pardiso", "dense"}
    assert "too slowly" in found.reason


def test_choice_by_size():
    assert [c.name for c in choose(ScaledSystem.of(np.eye(3), np.ones(3)))] == ["dense"]
    assert [c.name for c in choose(ScaledSystem.of(laplacian(20), np.ones(400)))] == ["dense"]
    quick = choose(ScaledSystem.of(laplacian(60), np.ones(3600)))
    assert [c.name for c in quick] == ["pardiso" if Pardiso.available() else "superlu"]
    assert "a factorisation is quick" in quick[0].reason
    assert choose(ScaledSystem.of(laplacian(120), np.ones(14400)))[0].name == "ssor"


@pytest.mark.parametrize("n", [5, 40])
def test_split_matrix_of_overrelaxation(n):
    """``K^-1 A K^-T`` by two triangular solutions, A being scaled to a unit diagonal."""
    system = ScaledSystem.of(laplacian(n), np.ones(n * n))
    split, full = Split.of(system), system.scaled_array()
    lower = np.tril(full, -1) + np.eye(n * n) / OMEGA
    np.testing.assert_allclose(to_array(split.lower), lower, atol=1e-15)
    np.testing.assert_allclose(to_array(split.upper)[::-1, ::-1], lower.T, atol=1e-15)
    vector = np.random.default_rng(0).standard_normal(n * n)
    expected = np.linalg.solve(lower, full @ np.linalg.solve(lower.T, vector))
    np.testing.assert_allclose(split.apply(vector), expected, atol=1e-12 * np.abs(expected).max())


def test_overrelaxation_takes_a_third_of_the_steps():
    matrix, load = laplacian(60), np.random.default_rng(0).standard_normal(3600)
    few, many = (solve(matrix, load, name, tolerance=1e-11) for name in ("ssor", "cg"))
    assert few.residual < 1e-11
    assert few.iterations < 0.45 * many.iterations
