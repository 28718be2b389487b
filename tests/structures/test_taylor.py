"""Generalised Taylor polynomials: Theorem 7 at random boundary points, both normalisers, structures from psi's."""

from __future__ import annotations

from math import factorial

import numpy as np
import pytest

import rfm.geometry as g
from rfm.calculus.jets import partials
from rfm.errors import StructureError
from structures.catalogue.entry import random_field, random_fields, random_points
from structures.catalogue.traces import BoundaryJets, boundary_frame, flux, normal_derivative, value
from structures.features import Point, Region, normalised
from structures.field_expression import field
from structures.jet_matrix import evaluate
from structures.operator import D, known, unknown
from structures.taylor import NORMALISERS, taylor
from structures.taylor_example import hole_slope, hole_value, rim_value, taylor_example

ELLIPSE = g.ellipse(center=(0.1, -0.05), semi_axes=(1.0, 0.7), angle=0.3).named("rim")
BALL = g.ellipsoid(center=(0.0, 0.1, 0.0), semi_axes=(1.0, 0.8, 0.9)).named("skin")
SQUARE = g.rectangle(min=(0, 0), max=(1, 1)).named("box")


def traces_of(f, domain, part, points, order):
    normal, curvature = boundary_frame(domain, part, points)
    u = known(domain.dimension, f)
    return BoundaryJets(points, normal, curvature, evaluate(u, tuple(points), order).offset[None])


@pytest.mark.parametrize("normaliser", NORMALISERS)
@pytest.mark.parametrize(("domain", "order"), [(ELLIPSE, 1), (ELLIPSE, 3), (SQUARE, 2), (BALL, 2)])
def test_theorem_7(domain, order, normaliser):
    rng = np.random.default_rng(3)
    part = domain.part("box.left") if domain is SQUARE else domain.part("all")
    data = [random_field(domain.dimension, rng) for _ in range(order + 1)]
    w = normalised(domain, part, order)
    f = taylor(w, data, domain.dimension, normaliser).offset
    jets = traces_of(f, domain, part, random_points(domain, part, rng, 200), order)
    for k, datum in enumerate(data):
        assert normal_derivative(datum, k).relative(jets) < 1e-11


@pytest.mark.parametrize("normaliser", NORMALISERS)
def test_theorem_7_to_fourth_order(normaliser):
    test_theorem_7(ELLIPSE, 4, normaliser)


def test_composition_is_the_extension_of_the_geometry():
    rng = np.random.default_rng(0)
    f, w = random_field(2, rng), normalised(ELLIPSE, ELLIPSE.part("all"), 1)
    points = tuple(random_points(ELLIPSE, ELLIPSE.part("all"), rng, 20) * 0.9)
    got = partials(taylor(w, [f, 0.0], 2, "composition").offset, points, 2)
    assert got == pytest.approx(partials(g.extend(f, w, 2), points, 2), rel=1e-12, abs=1e-12)


def test_normalisers_agree_to_the_order_of_w():
    rng = np.random.default_rng(0)
    part, f = ELLIPSE.part("all"), random_field(2, rng)
    w = normalised(ELLIPSE, part, 2)
    one, two = (known(2, taylor(w, [f, 0.0, 0.0], 2, name).offset) for name in NORMALISERS)
    points = random_points(ELLIPSE, part, rng, 50)
    inward = -boundary_frame(ELLIPSE, part, points)[0]
    inside = [tuple(points + t * inward) for t in (0.02, 0.01)]
    gaps = [np.abs(evaluate(one - two, x, 0).offset).max() for x in inside]
    assert np.log2(gaps[0] / gaps[1]) == pytest.approx(3.0, abs=0.15)


def test_the_remainder_is_free():
    # u = P + w^(m+1) psi: the next derivative is (m+1)! psi more
    rng = np.random.default_rng(1)
    part, psi = ELLIPSE.part("all"), random_field(2, rng)
    w = normalised(ELLIPSE, part, 2)
    u = (w**2 * unknown(2)).apply(psi)
    jets = traces_of(u, ELLIPSE, part, random_points(ELLIPSE, part, rng, 100), 2)
    wanted = lambda x, y: factorial(2) * psi(x, y)  # noqa: E731
    assert normal_derivative(wanted, 2).relative(jets) < 1e-12


def test_the_polynomial_of_unknowns_is_the_neumann_structure():
    # (7.13): the polynomial of (psi, phi) is psi - w D psi + w phi
    rng = np.random.default_rng(2)
    part, phi = ELLIPSE.part("all"), random_field(2, rng)
    w, psi = normalised(ELLIPSE, part, 1), unknown(2)
    made = taylor(w, [psi, phi], 2)
    paper = psi - w * D(w, psi) + w * field(phi)
    chosen = random_fields([made], rng)
    points = random_points(ELLIPSE, part, rng, 50) * 0.9
    one, two = (partials(op.apply(chosen), tuple(points), 2) for op in (made, paper))
    assert one == pytest.approx(two, rel=1e-12, abs=1e-12)


@pytest.mark.parametrize("normaliser", NORMALISERS)
def test_two_polynomials_and_their_interpolant(normaliser):
    example = taylor_example(normaliser)
    rng = np.random.default_rng(5)
    for f in (example.hole, example.interpolant):
        part = example.domain.part("hole")
        jets = traces_of(f, example.domain, part, random_points(example.domain, part, rng, 300), 1)
        assert value(hole_value).relative(jets) < 1e-13
        assert flux(lambda x, y: -hole_slope(x, y)).relative(jets) < 1e-12
    for f in (example.rim, example.interpolant):
        part = example.domain.part("rim")
        jets = traces_of(f, example.domain, part, random_points(example.domain, part, rng, 300), 0)
        assert value(rim_value).relative(jets) < 1e-12


def test_errors():
    with pytest.raises(StructureError, match="at least the value"):
        taylor(1.0, [], 2)
    with pytest.raises(StructureError, match="choose one of jets, composition"):
        taylor(1.0, [1.0], 2, "taylor")
    with pytest.raises(StructureError, match="normaliser='jets'"):
        taylor(field(lambda x, y: x), [unknown(2), 1.0], 2, "composition")


def test_no_normal_where_there_is_none():
    with pytest.raises(StructureError, match="is a point and has no normal: prescribe a value"):
        Point((0.0, 0.0)).normalised(1)
    with pytest.raises(StructureError, match="is a region and has no normal"):
        Region(ELLIPSE).normalised(1)


def test_normalisation_beyond_the_smoothness_of_the_shape():
    from rfm.calculus.functions import absolute
    from rfm.geometry import Box

    rough = g.function(
        expression=lambda x, y: y + 0.3 * absolute(y) ** 1.5 * (2 + x), box=Box((-1.0, -1.0), (1.0, 1.0))
    )
    with pytest.raises(StructureError, match="cannot be normalised to order 2"):
        normalised(rough, rough.part("all"), 2)
    assert normalised(rough, rough.part("all"), 1) is not None
