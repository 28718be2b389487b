"""Conditions that end in the middle of a smooth surface: the order of the splines, wherever the end is in its cell."""

from __future__ import annotations

import numpy as np
import pytest

from rfm.calculus.functions import exp, sin
from rfm.geometry import disk
from solvers import ritz
from solvers.background import prepare
from solvers.equations.poisson import Poisson
from solvers.norms import error_norms
from solvers.piece_ends import cut_at_ends
from solvers.problem import FROM_EXACT, Dirichlet, Discretization, Neumann, Problem
from solvers.stopwatch import Stopwatch

ANNULUS = disk(center=(0.5, 0.5), radius=0.4).named("outer") - disk(center=(0.5, 0.5), radius=0.1).named(
    "inner"
)


def wave(x, y):
    return exp(0.7 * x) * sin(2 * y + 0.3 * x + 0.4) + 0.3 * x * y * y


def half_and_half(end, right, left):
    outer = ANNULUS.part("outer")
    return Problem(
        ANNULUS,
        Poisson(source=None),
        (
            Dirichlet(ANNULUS.part("inner"), FROM_EXACT),
            right(outer.restricted(lambda x, y: x - end), FROM_EXACT),
            left(outer.restricted(lambda x, y: end - x), FROM_EXACT),
        ),
        exact=wave,
    )


def error(problem, degree, grid):
    solution = ritz.solve(problem, Discretization(degree=degree, grid=grid))
    return error_norms(solution.trial, wave, solution.background).l2


@pytest.mark.parametrize("end", [0.5, 0.5333])
@pytest.mark.parametrize("degree", [2, 4])
def test_value_beside_a_flux_keeps_the_order(end, degree):
    problem = half_and_half(end, Dirichlet, Neumann)
    errors = [error(problem, degree, grid) for grid in (16, 24)]
    assert np.log(errors[0] / errors[1]) / np.log(1.5) > degree + 1 - 0.3


def test_two_values_meet():
    """Plain rules leave 1e-7 at N = 32; the graded ones stop at 1e-10, where the last box is too large."""
    assert error(half_and_half(0.5, Dirichlet, Dirichlet), 4, 16) < 1e-9


def test_lengths_of_pieces():
    """Rules whose points are selected by `where` know where the piece ends."""
    end = 0.5333
    problem = half_and_half(end, Dirichlet, Neumann)
    background = prepare(ANNULUS, Discretization(degree=2, grid=16), Stopwatch())
    angle = np.arccos((end - 0.5) / 0.4)
    (outer,) = (s for s in background.rules.boundary if s.label == ("outer",))
    lengths = []
    for rules in (background.rules, cut_at_ends(problem, background, 7).rules):
        batch = rules.boundary[outer]
        assert batch.weights.sum() == pytest.approx(0.8 * np.pi, rel=1e-10)
        right = batch.points(background.grid)[0] > end
        lengths.append(batch.weights[right].sum())
    assert abs(lengths[0] - 0.8 * angle) > 1e-4
    assert lengths[1] == pytest.approx(0.8 * angle, abs=1e-8)
