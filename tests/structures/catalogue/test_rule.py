"""The general rule, parts that meet at corners, and conditions that cannot hold together."""

from __future__ import annotations

import numpy as np
import pytest

import rfm.geometry as g
from rfm.calculus.functions import exp, sin
from rfm.calculus.jets import partials
from rfm.errors import StructureError
from structures.catalogue import traces
from structures.catalogue.clamped import clamped
from structures.catalogue.compatibility import check
from structures.catalogue.entry import OnBoundary, random_fields, random_points
from structures.catalogue.multipart import multipart
from structures.catalogue.neumann import neumann
from structures.catalogue.plate_conditions import Moment, Shear
from structures.catalogue.rule import Site, corrected
from structures.catalogue.samples import ELLIPSE, PLATE, RECTANGLE, first, positive, second
from structures.catalogue.scalar_conditions import Flux, Oblique, Value
from structures.catalogue.supported import supported
from structures.catalogue.traction import lame
from structures.catalogue.vector_conditions import Components, Normal, Tangential, Traction
from structures.features import normalised
from structures.jet_matrix import evaluate
from structures.layers import directional, layer, partial
from structures.operator import differentiated, unknown

LEFT, BOTTOM = RECTANGLE.part("box.left"), RECTANGLE.part("box.bottom")


def same(one, two, points):
    psi = random_fields([one, two], np.random.default_rng(0))
    values = [partials(op.apply(psi), points, 1) for op in (one, two)]
    assert values[0] == pytest.approx(values[1], rel=1e-11, abs=1e-11)


def test_the_rule_gives_the_structure_of_the_paper():
    # (7.13) with the flux outward, and no second unknown
    w = normalised(ELLIPSE, ELLIPSE.part("all"), 1)
    (by_rule,) = corrected([unknown(2)], Site.of(w, [Flux(first, positive)]))
    points = tuple(random_points(ELLIPSE, ELLIPSE.part("all"), np.random.default_rng(1), 30) * 0.8)
    same(by_rule + w**2 * unknown(2, 1), neumann(w, 2, first, positive), points)


def test_the_rule_gives_the_clamped_taylor_polynomial():
    w = normalised(ELLIPSE, ELLIPSE.part("all"), 1)
    conditions = [Flux(second), Value(first)]  # sorted by order
    (by_rule,) = corrected([unknown(2)], Site.of(w, conditions))
    assert by_rule.terms == ()
    points = tuple(random_points(ELLIPSE, ELLIPSE.part("all"), np.random.default_rng(1), 30) * 0.8)
    same(by_rule + w**2 * unknown(2), clamped(w, 2, first, second), points)


def test_layers_differentiate_like_the_field_they_stand_for():
    w = normalised(ELLIPSE, ELLIPSE.part("all"), 1)
    u = layer(w, [unknown(2), unknown(2, 1), first * unknown(2, 2)])
    points = tuple(np.random.default_rng(1).random((2, 20)) * 0.5)
    same(partial(u, 1).total(), differentiated(u.total(), 1), points)
    along = directional((w, w), u - 2.0 * layer(w, [unknown(2)]))
    full = w * (differentiated(u.total(), 0) + differentiated(u.total(), 1))
    same(
        along.total(),
        full - 2.0 * w * (differentiated(unknown(2), 0) + differentiated(unknown(2), 1)),
        points,
    )


def test_simply_supported_disk_has_the_curvature_term():
    # u = w psi on a disk of radius R: M = -D (u_nn + nu / R u_n) = 0 for every psi
    radius, nu = 0.8, 0.25
    disk = g.disk(center=(0, 0), radius=radius)
    u = supported(normalised(disk, disk.part("all"), 1), nu)
    angle = np.linspace(0, 6, 50)
    x, y = radius * np.cos(angle), radius * np.sin(angle)
    psi = {0: lambda x, y: exp(x) * sin(y + 0.3), 1: lambda x, y: x - y}
    tables = {m: partials(f, (x, y), 2 + u.order) for m, f in psi.items()}
    _, ux, uy, uxx, uxy, uyy = evaluate(u, (x, y), 2).apply(tables)
    c, s = np.cos(angle), np.sin(angle)
    normal, bend = c * ux + s * uy, c * c * uxx + 2 * c * s * uxy + s * s * uyy
    assert bend + nu / radius * normal == pytest.approx(np.zeros(50), abs=1e-12)
    assert np.abs(normal).max() > 0.1


def test_fluxes_at_a_right_angle_one_after_the_other():
    # with compatible data extended by the exact solution the plain corrections are already exact
    exact = lambda x, y: sin(x + 2 * y) * exp(x)  # noqa: E731
    slope = [lambda x, y, k=k: partials_of(exact, x, y)[1 + k] for k in (0, 1)]
    (u,) = [unknown(2)]
    for part, datum in ((LEFT, slope[0]), (BOTTOM, slope[1])):
        (u,) = corrected([u], Site.of(normalised(RECTANGLE, part, 1), [Flux(lambda x, y, d=datum: -d(x, y))]))
    checks = [
        (part, traces.flux(lambda x, y, d=d: -d(x, y))) for part, d in ((LEFT, slope[0]), (BOTTOM, slope[1]))
    ]
    assert u.order == 2
    assert max(OnBoundary(RECTANGLE, [u], checks).residual(3, 200).values()) < 1e-12


def partials_of(f, x, y):
    from rfm.calculus.jets import derivatives

    return derivatives(f, (x, y), 1)


def test_any_data_at_a_corner():
    # incompatible data: exact on both parts all the same, away from the corner
    prescribed = [(LEFT, [Flux(1.0)]), (BOTTOM, [Flux(lambda x, y: -3.0 + x, 2.0)])]
    for successive in (False, True):
        u = multipart(RECTANGLE, prescribed, successive=successive)
        checks = [(LEFT, traces.flux(1.0)), (BOTTOM, traces.flux(lambda x, y: -3.0 + x, 2.0))]
        assert max(OnBoundary(RECTANGLE, u, checks).residual(3, 500).values()) < 1e-10


def test_obtuse_corner_and_three_dimensions():
    pentagon = g.polygon(vertices=[(0, 0), (1, -0.2), (1.4, 0.6), (0.7, 1.2), (-0.2, 0.7)]).named("p")
    kinds = [Flux(first), Flux(second, positive, 0.5), Value(first), Flux(0.3), Value(first)]
    u = multipart(pentagon, [(pentagon.part(f"p.edge{k}"), [c]) for k, c in enumerate(kinds)])
    flux = [traces.flux(first), traces.flux(second, positive, 0.5), None, traces.flux(0.3), None]
    checks = [(pentagon.part(f"p.edge{k}"), t or traces.value(first)) for k, t in enumerate(flux)]
    assert max(OnBoundary(pentagon, u, checks).residual(1, 300).values()) < 1e-10
    can = g.cylinder(center=(0, 0, 0), axis=(0, 0, 1), radius=0.6, height=1.0).named("can")
    held = [
        (can.part("can.bottom"), [Components((0.0, first, 0.0))]),
        (can.part("can.lateral"), [Normal(second, 3)]),
        (can.part("can.top"), [Traction((first, second, 1.0), (1.0, 0.7))]),
    ]
    u3 = multipart(can, held, components=3)
    checks3 = [
        (can.part("can.bottom"), traces.value(first, 1)),
        (can.part("can.lateral"), traces.normal_component(second)),
        (can.part("can.top"), traces.traction((first, second, 1.0), (1.0, 0.7))),
    ]
    assert max(OnBoundary(can, u3, checks3).residual(1, 300).values()) < 1e-10


def test_lame_parameters():
    # uniaxial plane stress: lambda e_xx + ... with e_yy = -nu e_xx gives sigma_yy = 0 and sigma_xx = E e_xx
    first_parameter, shear = lame(2.0, 0.3, "plane_stress")
    trace = 1.0 - 0.3
    assert first_parameter * trace + 2 * shear == pytest.approx(2.0)
    assert first_parameter * trace - 0.6 * shear == pytest.approx(0.0)
    with pytest.raises(StructureError, match="choose one of plane_stress"):
        lame(1.0, 0.3, "plain_stress")
    with pytest.raises(StructureError, match=r"between -1 and 0\.5"):
        lame(1.0, 0.5)


RIM = PLATE.part("rim")
CLAMPED = [Value(0.0), Flux(0.0)]
FREE = [Moment(0.0, 0.3), Shear(0.0, 0.3)]


@pytest.mark.parametrize(
    ("prescribed", "order", "message"),
    [
        ([(RIM, CLAMPED), (RIM, FREE)], 4, "clamped .* and free .*keep one of them, or separate .*where"),
        ([(RIM, CLAMPED + FREE)], 4, "cannot hold together"),
        (
            [(RIM, [Value(0.0)])],
            4,
            "value only, an equation of order 4 needs 2 conditions: make the edge clamped",
        ),
        ([(RIM, [Value(0.0), Flux(0.0)])], 2, "one is the reaction to the other"),
        ([(RIM, [Value(0.0), Value(1.0)])], 2, "both determine the same derivative"),
        ([(RIM, [Moment(0.0, 0.3)])], 2, "needs an equation of fourth order"),
        ([(RIM, [])], 2, "carries no condition"),
        ([(RIM, [Components((0.0, None)), Traction((0.0, 0.0), (1.0, 1.0))])], 2, "cannot hold together"),
        ([(RIM, [Components((0.0, 0.0)), Normal(0.0, 2)])], 2, "same derivative"),
        ([(PLATE.part("all"), [Value(0.0)]), (RIM, [Flux(0.0)])], 2, "rim carries conditions twice"),
    ],
)
def test_conditions_that_cannot_hold(prescribed, order, message):
    with pytest.raises(StructureError, match=message):
        check(prescribed, order)


@pytest.mark.parametrize(
    ("prescribed", "order"),
    [
        ([(RIM, CLAMPED), (PLATE.part("hole"), FREE)], 4),
        ([(RIM, [Value(0.0), Moment(0.0, 0.3)])], 4),
        ([(RIM, [Flux(0.0), Shear(0.0, 0.3)])], 4),
        ([(RIM, [Normal(0.0, 2), Tangential((0.0, 0.0))])], 2),
        ([(RIM.restricted(lambda x, y: x), [Value(0.0)]), (RIM.restricted(lambda x, y: -x), [Flux(0.0)])], 2),
    ],
)
def test_conditions_that_can(prescribed, order):
    check(prescribed, order)


def test_other_errors():
    with pytest.raises(StructureError, match="2 components; every condition must have as many"):
        multipart(PLATE, [(RIM, [Value(0.0)])], components=2)
    w = normalised(PLATE, RIM, 1)
    with pytest.raises(StructureError, match="3 components in 2 dimensions"):
        corrected([unknown(2)], Site.of(w, [Oblique(0.0, (1.0, 0.0, 0.0))]))
    ball = g.ball(center=(0, 0, 0), radius=1)
    with pytest.raises(StructureError, match="edges in the plane"):
        corrected([unknown(3)], Site.of(normalised(ball, ball.part("all"), 1), [Moment(0.0, 0.3)]))
