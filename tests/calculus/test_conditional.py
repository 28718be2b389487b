"""Implication, conditional operations and choice: truth tables, and nothing done where the condition fails."""

from functools import partial
from itertools import product

import numpy as np
import pytest

from rfm.calculus.intervals import Interval
from rfm.calculus.jets import partials
from rfm.calculus.r_systems import (
    R0,
    R1,
    RNorm,
    Rp,
    RSystem,
    choice,
    conditional_conjunction,
    conditional_disjunction,
    implication,
)

by_system = pytest.mark.parametrize("r", [R1(), R0, Rp(4), RNorm(2)], ids=repr)
F, G, C = np.array(list(product([-1.3, -0.4, 0.7, 2.0], repeat=3))).T


@by_system
def test_truth_tables(r: RSystem) -> None:
    f, g, c = F > 0, G > 0, C > 0
    for value, expected in (
        (implication(F, G, r), ~f | g),
        (conditional_conjunction(F, G, C, r), f & (g | ~c)),
        (conditional_disjunction(F, G, C, r), f | (g & c)),
        (choice(C, F, G, r), np.where(c, f, g)),
    ):
        np.testing.assert_array_equal(value > 0, expected)
        np.testing.assert_array_equal(value < 0, ~expected)


@by_system
def test_the_cut_keeps_its_slope(r: RSystem) -> None:
    """On g = 0, where f and the condition are positive, the gradient is that of g."""
    other = np.array([0.5, 2.0])
    for operation, sign in ((conditional_conjunction, 1.0), (conditional_disjunction, -1.0)):
        of_three = partial(operation, system=r)
        value, *slopes = partials(of_three, (sign * other, 0.0 * other, other), 1)
        np.testing.assert_allclose(value, 0.0, atol=1e-15)
        np.testing.assert_allclose(slopes, [[0, 0], [1, 1], [0, 0]], atol=1e-14)


def test_trimming_volume_of_a_triangle() -> None:
    """Edges of a triangle that cut a disk each in its own sector only."""
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])

    def volume(x, y):  # type: ignore[no-untyped-def]
        result = 4.0 - x * x - y * y
        for i in range(3):
            (ax, ay), (bx, by) = corners[i], corners[(i + 1) % 3]
            edge = (bx - ax) * (y - ay) - (by - ay) * (x - ax)
            result = conditional_conjunction(result, edge, 4.0 - (x - ax) ** 2 - (y - ay) ** 2)
        return result

    x, y = np.random.default_rng(1).uniform(-0.5, 1.2, (2, 500))
    np.testing.assert_array_equal(volume(x, y) > 0, (x > 0) & (y > 0) & (x + y < 1))
    box = volume(Interval(x - 0.01, x + 0.01), Interval(y - 0.01, y + 0.01))
    assert box.contains(volume(x, y)).all()
