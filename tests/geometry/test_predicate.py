"""Predicates: simplification, substitution, products, and when Theorem 4 keeps the normalisation."""

from __future__ import annotations

import numpy as np
import pytest
from boundary_sampling import boundary_points
from hypothesis import given, settings
from hypothesis import strategies as st

import rfm.geometry as g
from rfm.calculus.intervals import Interval
from rfm.calculus.jets import partials
from rfm.errors import GeometryError
from rfm.geometry.predicate import (
    And,
    Name,
    Not,
    Predicate,
    normalised_function,
    shape,
    simplified,
)

a, b, c = Name("a"), Name("b"), Name("c")
DISK = g.disk((0, 0), 1).named("a")
BLOCK = g.rectangle((0, -0.5), (2, 0.75)).named("b")
OVAL = g.ellipse((0.5, 0.5), (1.2, 0.7), 0.4).named("c")
SHAPES = {"a": DISK, "b": BLOCK, "c": OVAL}

predicates = st.recursive(
    st.sampled_from([a, b, c]),
    lambda inner: st.one_of(
        inner.map(lambda p: ~p),
        st.tuples(
            st.sampled_from(["__and__", "__or__", "__xor__", "__sub__", "implies", "iff"]), inner, inner
        ).map(lambda t: getattr(t[1], t[0])(t[2])),
    ),
    max_leaves=7,
)


def table(predicate: Predicate) -> np.ndarray:
    rows = np.indices((2, 2, 2)).reshape(3, -1).astype(bool)
    return np.asarray(predicate.evaluate(dict(zip("abc", rows, strict=True))))


@settings(max_examples=200, deadline=None)
@given(predicates)
def test_simplification_keeps_the_truth(predicate: Predicate) -> None:
    truth = table(predicate)
    if truth.all() or not truth.any():
        with pytest.raises(GeometryError, match="there is no boundary"):
            simplified(predicate)
        return
    simple = simplified(predicate)
    np.testing.assert_array_equal(table(simple), truth)
    assert set(simple.names) <= set(predicate.names)
    stack: list[Predicate] = [simple]
    while stack:  # negation stands at names only
        node = stack.pop()
        assert not isinstance(node, Not) or isinstance(node.of, Name)
        stack.extend(node.children)


@settings(max_examples=100, deadline=None)
@given(predicates, st.sampled_from(["r1", "r0", "rp4", "ralpha0.5", "rnorm2", "spline2"]))
def test_function_of_a_predicate_has_its_sign_in_every_system(predicate: Predicate, system: str) -> None:
    truth = table(predicate)
    if truth.all() or not truth.any():
        return
    points = np.random.default_rng(5).uniform(-1.5, 2.5, (400, 2))
    inside = predicate.evaluate({name: s.contains(points) for name, s in SHAPES.items()})
    domain = shape(predicate, SHAPES).using(system)
    np.testing.assert_array_equal(domain.contains(points), inside)
    values = domain.membership(*points.T)
    decided = np.abs(values) > 1e-12
    np.testing.assert_array_equal((values > 0)[decided], inside[decided])


@pytest.mark.parametrize(
    ("predicate", "text"),
    [
        (a & (a | b), "a"),
        (a & b | a & ~b, "a"),
        (a ^ a ^ b, "b"),
        ((a & b) ^ a, "~b & a"),
        (~(a & (b | ~c)), "~a | ~b & c"),
        ((a @ b) & (a @ b | c), "a @ b"),
        (a.implies(b), "~a | b"),
        (a & b & a, "a & b"),
    ],
)
def test_simplified_texts(predicate: Predicate, text: str) -> None:
    assert str(simplified(predicate)) == text


def test_texts_show_the_structure() -> None:
    assert str(a.iff(b) - (a | b & c)) == "iff(a, b) & ~(a | b & c)"
    assert str((a | b) @ c) == "(a | b) @ c"
    assert str(a ^ b | c) == "a ^ b | c"


@pytest.mark.parametrize(
    ("predicate", "message"),
    [
        (a & ~a, "the predicate a & ~a holds nowhere: there is no boundary"),
        (a.implies(a), "the predicate implies(a, a) holds everywhere: there is no boundary"),
        (a & Name("d"), "no shape is called 'd' (shapes: a, b, c)"),
    ],
)
def test_refused_predicates(predicate: Predicate, message: str) -> None:
    with pytest.raises(GeometryError) as caught:
        shape(predicate, SHAPES)
    assert str(caught.value) == message


def test_product_is_a_cylinder() -> None:
    """disk @ interval has the sign of the primitive cylinder, the same box, and the names of both."""
    product = g.disk((0.2, 0.1), 0.7).named("base") @ g.interval(-1, 2).named("height")
    cylinder = g.cylinder((0.2, 0.1, 0.5), (0, 0, 1), 0.7, 3)
    points = np.random.default_rng(1).uniform(-2.5, 2.5, (4000, 3))
    np.testing.assert_array_equal(product.contains(points), cylinder.contains(points))
    assert product.parts == ("base", "height", "height.bottom", "height.top")
    np.testing.assert_allclose(product.box.lower, cylinder.box.lower, atol=1e-15)
    np.testing.assert_allclose(product.box.upper, cylinder.box.upper, atol=1e-15)
    turned = [s.rotate(0.7, axis=(1, 1, 0)).move((1, 0, 0)) for s in (product, cylinder)]
    np.testing.assert_allclose(turned[0].box.upper, turned[1].box.upper, atol=1e-14)
    np.testing.assert_array_equal(turned[0].contains(points), turned[1].contains(points))
    bound = product.membership(Interval(0.0, 0.1), Interval(0.0, 0.1), Interval(0.0, 0.1))
    assert bound.lo <= float(product.membership(0.05, 0.05, 0.05)) <= bound.hi


def test_product_of_intervals_and_of_a_polygon_with_pieces() -> None:
    square = g.interval(0, 1).named("x") @ g.interval(0, 2).named("y")
    points = np.random.default_rng(2).uniform(-1, 3, (2000, 2))
    np.testing.assert_array_equal(square.contains(points), g.rectangle((0, 0), (1, 2)).contains(points))
    assert (square @ g.interval(0, 3).named("z")).dimension == 3
    comb = g.polygon([(0, 0), (3, 0), (3, 2), (2, 2), (2, 1), (1, 1), (1, 2), (0, 2)]).named("u")
    bar = comb @ g.interval(0, 1)
    side = bar.part("u.edge2")  # shares its line with edge6
    assert side.selects(np.array([[2.5, 2.0, 0.5]])).all()
    assert not side.selects(np.array([[0.5, 2.0, 0.5]])).any()


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: DISK ^ g.ball((0, 0, 0), 1), "shapes of dimension 2 and 3 cannot be combined"),
        (
            lambda: DISK @ DISK,
            "a product of shapes of dimension 2 and 2 has more than three dimensions",
        ),
        (lambda: g.interval(1, 1), "max must exceed min, got 1 and min 1"),
        (lambda: g.interval(0, float("nan")), "max must be finite, got nan"),
        (lambda: DISK.intersect(BLOCK, "rp3"), "R_p needs an even p >= 2, got 3"),
        (
            lambda: DISK.intersect(BLOCK, "ralpha-1"),
            "R_alpha needs -1 < alpha < 1, got -1.0; alpha = 1 is the system r1",
        ),
        (lambda: DISK.using("rp4") & BLOCK.using("r0"), "the shapes use different systems, "),
        (
            lambda: normalised_function(DISK & BLOCK, 2, "r0"),
            "order of normalisation 2 is higher than r0 keeps (1); take rp4 or a lower order",
        ),
        (
            lambda: normalised_function((DISK & BLOCK) | (DISK & OVAL), 1),
            "Theorem 4 does not apply: mentioned more than once at a point: a; normalise the finished function "
            "with distance(shape, part, order)",
        ),
    ],
)
def test_refused_operations(build: object, message: str) -> None:
    with pytest.raises(GeometryError) as caught:
        build()  # type: ignore[operator]
    assert str(caught.value).startswith(message)


def test_unknown_system_is_named() -> None:
    with pytest.raises(GeometryError, match="unknown R-system 'best'"):
        DISK.unite(BLOCK, "best")


def test_an_operation_keeps_its_system_through_the_algebra() -> None:
    """Values follow the node's system; signs never do."""
    domain = (DISK.intersect(BLOCK, "rp4") | OVAL).move((0.5, 0)).named("d")
    plain = ((DISK & BLOCK) | OVAL).move((0.5, 0))
    points = np.random.default_rng(3).uniform(-1, 3, (500, 2))
    np.testing.assert_array_equal(domain.contains(points), plain.contains(points))
    p, q = 0.4, 0.3
    corner = DISK.intersect(g.half_plane((0, 0), (1, 0)), "rp4")
    x = np.array([[p, q]])
    f, h = (1 - p * p - q * q) / 2, p
    assert corner.membership(*x.T)[0] == pytest.approx(f + h - (f**4 + h**4) ** 0.25, rel=1e-15)
    assert (~corner).membership(*x.T)[0] == pytest.approx(-corner.membership(*x.T)[0], rel=1e-15)


def test_weight_of_an_operation_with_a_system() -> None:
    """The factors of an intersection with its own system are joined by it, not multiplied."""
    half = g.half_plane((0, 0), (1, 0)).named("h")
    hole = g.disk((0.4, 0), 0.1).named("hole")
    domain = DISK.intersect(half, "r0") - hole
    x, y = np.array([0.5]), np.array([0.3])
    f, h = (1 - x * x - y * y) / 2, x
    expected = (f + h - np.hypot(f, h)) * -hole.surfaces[0].function(x, y)
    np.testing.assert_allclose(g.weight(domain, domain.part("all"))(x, y), expected, rtol=1e-14)
    only = g.weight(domain, domain.part("h"))
    np.testing.assert_allclose(only(x, y), h)


REPORTS = [
    (DISK & BLOCK, "rp4", 1, 3, []),
    (DISK ^ BLOCK, "r0", 1, 1, []),
    (DISK.iff(OVAL) & g.rectangle((-2, -2), (3, 3)), "rp6", 1, 5, []),
    ((DISK & BLOCK) | (DISK & OVAL), "r0", 2, 1, ["a"]),
    (DISK & BLOCK, "r0m2", 1, 0, []),
]


@pytest.mark.parametrize(("domain", "system", "degree", "kept", "acting"), REPORTS)
def test_reports(domain: g.Shape, system: str, degree: int, kept: int, acting: list[str]) -> None:
    report = domain.report(system)
    assert report.inversion_degree == degree
    assert report.kept == kept
    assert [item.name for item in report.occurrences if item.degree > 1] == acting
    assert report.guaranteed is (degree == 1 and kept >= 1)


def test_report_beyond_what_can_be_tried_errs_on_the_safe_side() -> None:
    angles = np.linspace(0, 2 * np.pi, 20, endpoint=False)
    wheel = g.polygon(np.stack([np.cos(angles), np.sin(angles)], axis=1)).named("p")
    assert wheel.report("r0").guaranteed
    report = (wheel ^ g.disk((1, 0), 0.5).named("d")).report("r0")
    assert not report.guaranteed
    assert report.lines()[1].endswith(" more")


def test_report_says_where_the_function_vanishes_too_often() -> None:
    report = ((DISK | OVAL) & (~DISK | OVAL)).report("r0")
    assert [item.name for item in report.occurrences if item.spurious] == ["a"]
    assert report.lines()[-1] == "the function may vanish off the boundary too, on: a"
    assert And((a | c, ~a | c)).evaluate(SHAPES).report("r0").inversion_degree == 1
    assert str(simplified(And((a | c, ~a | c)))) == "c"


@pytest.mark.parametrize(("domain", "system", "degree"), [(d, s, n) for d, s, n, kept, _ in REPORTS if kept])
def test_slopes_are_what_the_report_says(domain: g.Shape, system: str, degree: int) -> None:
    """One where every mention acts alone; somewhere not, where two act together."""
    function = domain.using(system).membership
    slopes = []
    for surface in domain.surfaces:
        if not surface.normalised:
            continue
        points, normals = boundary_points(domain, surface, 400)
        jet = partials(function, tuple(points.T), 1)
        slopes.append((jet[1:] * normals.T).sum(axis=0))
    worst = np.abs(np.concatenate(slopes) - 1.0).max()
    assert bool(worst < 1e-9) is (degree == 1)


@pytest.mark.parametrize("order", [1, 2, 3, 4])
@pytest.mark.parametrize("name", ["intersection", "exclusive or", "product"])
def test_theorem_4(name: str, order: int) -> None:
    """Random regular boundary points: w = 0, dw/dn = 1, d^k w/dn^k = 0 for k = 2..m."""
    domain = {
        "intersection": DISK - OVAL.scale(0.5),
        "exclusive or": DISK ^ OVAL,
        "product": DISK @ g.interval(-0.6, 0.6),
    }[name]
    w = normalised_function(domain, order)
    checked = 0
    for surface in domain.surfaces:
        points, normals = boundary_points(domain, surface, 40)
        others = [np.abs(s.function(*points.T)) for s in domain.surfaces if s is not surface]
        keep = np.min(others, axis=0) > 0.1
        points, normals = points[keep], normals[keep]
        checked += len(points)

        jet = along_normals(w, points, normals, order)
        primitives = [along_normals(field, points, normals, order) for _, field in w.fields]
        # what cancels must not be large: not so near the focal points of the other surface
        calm = np.max(np.abs(primitives), axis=(0, 1)) < 1e6
        assert calm.mean() > 0.7
        assert np.abs(jet[0]).max() < 1e-12
        assert np.abs(jet[1] - 1.0)[calm].max() < 1e-11
        assert np.abs(jet[2:, calm]).max(initial=0.0) < 1e-7
    assert checked > 30


def along_normals(field: object, points: np.ndarray, normals: np.ndarray, order: int) -> np.ndarray:
    """Value and derivatives along the normal, ``(order + 1, n)``."""
    lines = list(zip(points.T, normals.T, strict=True))
    return partials(lambda t: field(*(x + t * n for x, n in lines)), (np.zeros(len(points)),), order)
