"""Solution and condition number of systems of splines that nearly depend on each other."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import csr_array, diags_array, eye_array, kron

from rfm.errors import NumericsError
from solvers.linear import overlapping
from solvers.linear.iterative import Record
from solvers.linear.overlapping import solve_reporting
from solvers.problem import SolverOptions
from solvers.systems import EnergySystem


def laplacian(n, shift=0.0):
    """Five-point Laplacian on n x n points, its diagonal constant."""
    line = diags_array([-np.ones(n - 1), 2 * np.ones(n), -np.ones(n - 1)], offsets=[-1, 0, 1])
    return csr_array(kron(line, eye_array(n)) + kron(eye_array(n), line) + shift * eye_array(n * n))


@pytest.fixture(scope="module")
def system():
    matrix = laplacian(60)
    return matrix, np.random.default_rng(0).standard_normal(matrix.shape[0])


@pytest.mark.parametrize(
    ("dimension", "method", "low", "high"), [(3, "cg", 0.98, 1.02), (2, "superlu", 0.5, 1.5)]
)
def test_solution_and_condition(system, dimension, method, low, high):
    matrix, load = system
    found = solve_reporting(matrix, load, 1e-11, dimension)
    assert found.method == method
    assert found.residual < 2e-11
    assert np.linalg.norm(matrix @ found.x - load) < 2e-11 * np.linalg.norm(load)
    exact = 1.0 / np.tan(np.pi / 122) ** 2
    assert low < found.condition / exact < high


def test_factorisation_when_steps_do_not_do(system, monkeypatch):
    monkeypatch.setattr(overlapping, "affordable", lambda n, entries: 5)
    found = solve_reporting(*system, 1e-11, 3)
    assert found.method == "superlu"
    assert "more than 5 steps" in found.reason


def test_indefinite_matrices_are_left_to_the_general_solvers(system):
    matrix = laplacian(60, -1.0)
    assert solve_reporting(matrix, system[1], 1e-11, 3) is None
    with pytest.raises(NumericsError, match="not positive definite"):
        EnergySystem(matrix, system[1]).solve_reporting(SolverOptions(), 3)


def test_nothing_to_solve_and_a_chosen_method(system):
    matrix, load = system
    assert EnergySystem(matrix, 0 * load).solve_reporting(SolverOptions(), 3).method == "none"
    chosen = EnergySystem(matrix, load).solve_reporting(SolverOptions(linear="amg"), 3)
    assert chosen.method == "amg"
    assert chosen.condition > 1e3


def test_no_steps_no_condition():
    assert Record().condition() == 1.0
