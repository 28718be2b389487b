"""Linear algebra beyond symmetric positive definite matrices: QR of overdetermined rows, LU and GMRES."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import csr_array, random_array

from rfm.errors import NumericsError
from solvers.linear import nonsymmetric
from solvers.linear.condition import factorise
from solvers.linear.least_squares import Overdetermined, solve_by_qr, work_of_qr
from solvers.linear.system import ScaledSystem


def banded_rows(rows=600, columns=90, slabs=30, width=12, seed=1):
    """Rows that meet a window of columns which moves with the slab, and a few columns far away."""
    generator = np.random.default_rng(seed)
    slab = generator.integers(0, slabs, rows)
    matrix = np.zeros((rows, columns))
    for row, s in enumerate(slab):
        start = s * (columns - width) // (slabs - 1)
        matrix[row, start : start + width] = generator.standard_normal(width)
    matrix[generator.integers(0, rows, 5), generator.integers(0, columns, 5)] = 1.0
    return matrix, generator.standard_normal(rows), slab


@pytest.mark.parametrize("seed", range(5))
def test_frontal_qr_agrees_with_lapack(seed):
    matrix, right, slab = banded_rows(seed=seed)
    found = solve_by_qr(Overdetermined(csr_array(matrix), right, slab), "test")
    expected = np.linalg.lstsq(matrix, right, rcond=None)[0]
    assert np.abs(found.x - expected).max() < 1e-12 * np.abs(expected).max()
    assert found.residual < 1e-13


def test_frontal_qr_does_not_square_the_condition_number():
    matrix, _, slab = banded_rows()
    matrix[:, 40] = matrix[:, 41] + 1e-9 * matrix[:, 40]
    x = np.linspace(1.0, 2.0, matrix.shape[1])
    found = solve_by_qr(Overdetermined(csr_array(matrix), matrix @ x, slab), "test").x
    assert np.abs(found - x).max() < 1e-5
    normal = np.linalg.solve(matrix.T @ matrix, matrix.T @ (matrix @ x))
    assert np.abs(normal - x).max() > 1e-3


def test_frontal_qr_costs_less_than_a_dense_one():
    matrix, right, slab = banded_rows(rows=6000, columns=900, slabs=300)
    dense = 2 * 6000 * 900**2
    assert work_of_qr(Overdetermined(csr_array(matrix), right, slab)) < 0.02 * dense


def test_dependent_columns_are_refused():
    matrix, right, slab = banded_rows()
    matrix[:, 7] = matrix[:, 8]
    with pytest.raises(NumericsError, match="do not determine the unknowns"):
        solve_by_qr(Overdetermined(csr_array(matrix), right, slab), "test")


def test_too_few_rows_are_refused():
    system = Overdetermined(csr_array(np.ones((2, 3))), np.ones(2), np.zeros(2, dtype=int))
    with pytest.raises(NumericsError, match="2 equations for 3 unknowns"):
        solve_by_qr(system, "test")


@pytest.mark.parametrize("size", [300, 3000])
@pytest.mark.parametrize("small", [1e-2, 1e-5])
def test_condition_estimates(size, small):
    """A path of springs and one that is nearly cut off: the condition number is known from its eigenvalues."""
    diagonal = np.linspace(1.0, 2.0, size)
    matrix = (
        csr_array(np.diag(diagonal)) if size < 1000 else csr_array((diagonal, (range(size), range(size))))
    )
    coupled = matrix.tolil()
    coupled[0, 1] = coupled[1, 0] = np.sqrt(diagonal[0] * diagonal[1]) * (1 - small)
    system = ScaledSystem.of(csr_array(coupled), np.ones(size))
    factors = factorise(system)
    assert factors.method == ("dense" if size < 2500 else "superlu")
    assert 0.3 < factors.condition / (2 / small) < 3


def advection_matrix(size, wind=0.3):
    ones = np.ones(size)
    rows = np.arange(size)
    return csr_array(
        (
            np.concatenate([2.1 * ones, (-1 - wind) * ones[1:], (-1 + wind) * ones[1:]]),
            (np.concatenate([rows, rows[1:], rows[:-1]]), np.concatenate([rows, rows[:-1], rows[1:]])),
        )
    )


@pytest.mark.parametrize("method", ["auto", *nonsymmetric.METHODS])
def test_methods_for_matrices_that_are_not_symmetric(method):
    matrix = advection_matrix(900)
    x = np.sin(np.arange(900))
    found = nonsymmetric.solve(matrix, matrix @ x, method)
    assert np.abs(found.x - x).max() < 1e-9
    assert found.residual < 1e-11


def test_rows_and_columns_of_any_size_do_not_matter():
    matrix = advection_matrix(200)
    generator = np.random.default_rng(3)
    rows, columns = (10.0 ** generator.uniform(-8, 8, 200) for _ in range(2))
    scaled = rows[:, None] * matrix.toarray() * columns
    x = np.cos(np.arange(200)) / columns
    found = nonsymmetric.solve(scaled, scaled @ x)
    assert np.abs((found.x - x) * columns).max() < 1e-11


def test_a_symmetric_solver_is_refused_for_a_matrix_that_is_not():
    with pytest.raises(NumericsError, match="cg needs a symmetric matrix: choose auto or"):
        nonsymmetric.solve(advection_matrix(10), np.ones(10), "cg")


def test_a_singular_matrix_is_refused():
    matrix = random_array((50, 50), density=0.5, rng=np.random.default_rng(0)).toarray()
    matrix[7] = matrix[8]
    with pytest.raises(NumericsError, match="singular"):
        nonsymmetric.solve(matrix, np.ones(50))
    matrix[7] = 0.0
    with pytest.raises(NumericsError, match="row 7 is zero"):
        nonsymmetric.solve(matrix, np.ones(50))
