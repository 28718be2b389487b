"""Every psi satisfies the conditions: residuals on every part, to rounding."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rfm.calculus.functions import cos, exp, sin
from rfm.calculus.jets import partials
from rfm.errors import StructureError
from rfm.geometry.primitives_2d import disk, rectangle
from rfm.geometry.primitives_3d import box
from structures.contact import boundary_points
from structures.dirichlet import dirichlet, merge
from structures.field_expression import Constant
from structures.jet_matrix import evaluate

seeds = st.integers(0, 2**32 - 1)


def solution(x, y):
    return exp(x) * sin(2 * y + 0.3) + x * y * y


def random_psi(seed, dimension=2):
    """A random cubic plus two random waves."""
    rng = np.random.default_rng(seed)
    a, b = rng.normal(size=(2, dimension))
    c, k, phase = rng.normal(size=(3, 3))

    def psi(*xs):
        t = sum(u * x for u, x in zip(a, xs, strict=True))
        s = sum(u * x for u, x in zip(b, xs, strict=True))
        return c[0] + t * (c[1] + s * (c[2] + t)) + sum(sin(k[i] * t + phase[i] * s) for i in range(3))

    return psi


def residual(domain, op, data, psi):
    """Largest |u - g| on the parts, and the number of points it was taken over on the emptiest part."""
    worst, fewest = 0.0, np.inf
    for part, g in data:
        coords = tuple(boundary_points(domain, part).T)
        u = evaluate(op, coords, 0).apply(partials(psi, coords, 0))[0]
        wanted = partials(g, coords, 0)[0] if callable(g) else g
        worst = max(worst, float(np.abs(u - wanted).max()))
        fewest = min(fewest, len(u))
    return worst, fewest


def wanted_disk():
    domain = disk(center=(0.2, 0.1), radius=0.7).named("d")
    return domain, [(domain.part("all"), solution)]


def annulus():
    domain = disk(center=(0.5, 0.5), radius=0.4).named("o") - disk(center=(0.5, 0.5), radius=0.1).named("i")
    return domain, [(domain.part("o"), solution), (domain.part("i"), 2.0)]


def four_sides():
    """Data that agree at the corners only: different extensions of one function."""
    domain = rectangle(min=(0, 0), max=(1, 1)).named("r")
    extensions = {
        "left": lambda x, y: solution(x, y) + x * (1 + sin(x + 2 * y)),
        "right": lambda x, y: solution(x, y) + (1 - x) * cos(x - y),
        "bottom": lambda x, y: solution(x, y) + y * exp(-x * y),
        "top": lambda x, y: solution(x, y) + (1 - y) * (1.3 - x + y * y),
    }
    return domain, [(domain.part(f"r.{side}"), g) for side, g in extensions.items()]


def three_holes():
    domain = rectangle(min=(0, 0), max=(2, 1)).named("plate")
    for k, (x, y, radius) in enumerate([(0.4, 0.5, 0.15), (1.0, 0.35, 0.1), (1.6, 0.6, 0.2)]):
        domain = domain - disk(center=(x, y), radius=radius).named(f"hole{k}")
    holes = [(domain.part(f"hole{k}"), 1.0 + k) for k in range(3)]
    return domain, [(domain.part("plate"), solution), *holes]


def two_disks():
    domain = disk(center=(0, 0), radius=1).named("a") | disk(center=(1.2, 0.3), radius=0.8).named("b")
    return domain, [(domain.part("all"), solution)]


def two_disks_two_formulas():
    domain, _ = two_disks()
    return domain, [(domain.part("a"), solution), (domain.part("b"), lambda x, y: solution(x, y) ** 2)]


def half_a_circle():
    """A condition on a piece of a part, none on the other piece."""
    domain = disk(center=(0, 0), radius=1).named("d")
    return domain, [(domain.part("d").restricted(lambda x, y: x - 0.2), solution)]


def two_halves():
    """Two conditions that share one circle, equal where they meet."""
    domain = disk(center=(0, 0), radius=1).named("d")
    right = domain.part("d").restricted(lambda x, y: x - 0.2)
    left = domain.part("d").restricted(lambda x, y: 0.2 - x)
    return domain, [(right, lambda x, y: x * y), (left, lambda x, y: 0.2 * y)]


def textbook_square():
    """The sine on the top is right on the left and on the right too."""
    domain = rectangle(min=(0, 0), max=(1, 1)).named("r")
    zeros = [(domain.part(f"r.{side}"), 0.0) for side in ("left", "right", "bottom")]
    return domain, [*zeros, (domain.part("r.top"), lambda x, y: sin(np.pi * x))]


def contradictory_square():
    domain = rectangle(min=(0, 0), max=(1, 1)).named("r")
    return domain, [(domain.part("r.top"), 1.0), (domain.part("r.left"), 0.0), (domain.part("r.bottom"), 0.0)]


CONFIGURATIONS = [
    wanted_disk,
    annulus,
    four_sides,
    three_holes,
    two_disks,
    two_disks_two_formulas,
    half_a_circle,
    two_halves,
    textbook_square,
]


@pytest.mark.parametrize("configuration", CONFIGURATIONS)
def test_every_psi_satisfies_the_conditions(configuration):
    domain, data = configuration()
    op = dirichlet(domain, data)

    @settings(max_examples=20, deadline=None)
    @given(seeds)
    def check(seed):
        worst, fewest = residual(domain, op, data, random_psi(seed))
        assert worst < 1e-11
        assert fewest >= 10

    check()


def test_contradictory_data_are_taken_away_from_the_corner():
    domain, data = contradictory_square()
    op = dirichlet(domain, data)
    for part, g in data:
        points = boundary_points(domain, part)
        points = points[np.hypot(points[:, 0], points[:, 1] - 1) > 1e-6]
        u = evaluate(op, tuple(points.T), 0).apply(partials(random_psi(3), tuple(points.T), 0))[0]
        assert np.abs(u - g).max() < 1e-12
    middle = evaluate(op, (np.array([0.0]), np.array([1.0])), 1).offset  # finite at the corner itself
    assert np.isfinite(middle).all()
    assert middle[0, 0] == pytest.approx(0.5)


@pytest.mark.parametrize("weight", ["auto", "product", "saturated", "r0"])
def test_in_space_with_an_edge_between_two_formulas(weight):
    domain = box(min=(0, 0, 0), max=(1, 1, 1)).named("b")
    left = (domain.part("b.left"), lambda x, y, z: y * z + x * cos(y))
    rest = (domain.part("all") - domain.part("b.left"), lambda x, y, z: y * z + x * exp(z))
    op = dirichlet(domain, [left, rest], weight=weight)
    worst, fewest = residual(domain, op, [left, rest], random_psi(5, 3))
    assert worst < 1e-11
    assert fewest > 100


def test_formulas_that_fit_other_parts_need_no_interpolation():
    domain, data = textbook_square()
    op = dirichlet(domain, data)
    x, y = np.random.default_rng(0).random((2, 50))
    values = partials(op.offset, (x, y), 2)
    assert values[0] == pytest.approx(y * np.sin(np.pi * x), abs=1e-3)
    assert np.abs(values[3:]).max() < 20


def test_without_conditions_u_is_psi():
    domain, _ = wanted_disk()
    jet = evaluate(dirichlet(domain, []), (np.zeros(3), np.ones(3)), 1)
    assert jet.pattern == {0: {(0, 0), (1, 1), (2, 2)}}
    assert not jet.offset.any()


def test_extra_is_added_to_psi():
    domain, data = annulus()
    x, y = np.random.default_rng(0).random((2, 20))
    plain = dirichlet(domain, data).apply(lambda x, y: random_psi(1)(x, y) + x * y)
    moved = dirichlet(domain, data, extra=lambda x, y: x * y).apply(random_psi(1))
    assert partials(moved, (x, y), 2) == pytest.approx(partials(plain, (x, y), 2), abs=1e-9)


def test_equal_formulas_are_one_piece():
    domain, _ = four_sides()
    left, right, bottom, top = (domain.part(f"r.{s}") for s in ("left", "right", "bottom", "top"))

    def zero(*_):
        return 0.0

    zero.source = "0.0"
    pieces = merge([(left, 0), (right, solution), (bottom, zero), (top, solution)])
    assert [len(piece.part.surfaces) for piece in pieces] == [2, 2]
    assert isinstance(pieces[0].value, Constant)


def test_two_values_on_one_surface_are_refused():
    domain, _ = four_sides()
    with pytest.raises(StructureError, match=r"r\.left carries two different Dirichlet values"):
        dirichlet(domain, [(domain.part("r.left"), 0.0), (domain.part("all"), 1.0)])
