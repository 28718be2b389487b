"""Boolean algebra of shapes, boxes, parts and motions."""

from __future__ import annotations

import numpy as np
import pytest
from boundary_sampling import boundary_points
from hypothesis import given, settings
from hypothesis import strategies as st

import rfm.geometry as g
from rfm.calculus.intervals import Interval
from rfm.errors import GeometryError
from rfm.geometry.shape import Shape

A = g.disk((0, 0), 1).named("A")
B = g.rectangle((0, -0.5), (2, 0.75)).named("B")
C = g.half_plane((0, 0.2), (0.3, 1)).named("C")
LEAVES = {"A": A, "B": B, "C": C}

trees = st.recursive(
    st.sampled_from(list(LEAVES)),
    lambda inner: st.tuples(st.sampled_from("&|-"), inner, inner) | st.tuples(st.just("~"), inner),
    max_leaves=8,
)


def shape_of(tree: object) -> Shape:
    match tree:
        case str():
            return LEAVES[tree]
        case ("~", inner):
            return ~shape_of(inner)
        case ("&", first, second):
            return shape_of(first) & shape_of(second)
        case ("|", first, second):
            return shape_of(first) | shape_of(second)
        case ("-", first, second):
            return shape_of(first) - shape_of(second)
    raise AssertionError(tree)


def set_of(tree: object, points: np.ndarray) -> np.ndarray:
    match tree:
        case str():
            return LEAVES[tree].contains(points)
        case ("~", inner):
            return ~set_of(inner, points)
        case ("&", first, second):
            return set_of(first, points) & set_of(second, points)
        case ("|", first, second):
            return set_of(first, points) | set_of(second, points)
        case ("-", first, second):
            return set_of(first, points) & ~set_of(second, points)
    raise AssertionError(tree)


@settings(max_examples=150, deadline=None)
@given(trees)
def test_boolean_algebra_and_boxes(tree: object) -> None:
    points = np.random.default_rng(3).uniform(-3, 3, (500, 2))
    shape, inside = shape_of(tree), set_of(tree, points)
    np.testing.assert_array_equal(shape.contains(points), inside)
    box = shape.box
    assert all(box.contains(tuple(point)) for point in points[inside])
    assert all(shape.outer_box.contains(tuple(point)) for point in points[~inside])


@settings(max_examples=100, deadline=None)
@given(trees)
def test_tri_state_signs_decide_like_points(tree: object) -> None:
    shape = shape_of(tree)
    points = np.random.default_rng(4).uniform(-2, 3, (200, 2))
    signs = {s: np.sign(s.function(*points.T)).astype(np.int8) for s in shape.surfaces}
    np.testing.assert_array_equal(shape.expression.evaluate(signs) > 0, shape.contains(points))


def test_undecided_signs_stay_undecided_only_where_they_matter() -> None:
    surface_a, first_b = A.surfaces[0], B.surfaces[0]
    union, both = A | B, A & B
    signs = {surface: np.int8(1) for surface in union.surfaces}
    assert union.expression.evaluate({**signs, first_b: np.int8(0)}) == 1
    assert both.expression.evaluate({**signs, first_b: np.int8(0)}) == 0
    assert both.expression.evaluate({**signs, first_b: np.int8(0), surface_a: np.int8(-1)}) == -1


def test_membership_on_intervals_encloses_points() -> None:
    shape = (A - B) | C
    low, high = np.array([-0.5, 0.25]), np.array([0.1, 0.5])
    bound = shape.membership(Interval(low[0], high[0]), Interval(low[1], high[1]))
    points = np.random.default_rng(0).uniform(low, high, (1000, 2))
    values = shape.membership(*points.T)
    assert bound.lo <= values.min()
    assert values.max() <= bound.hi


def test_boxes_of_operations() -> None:
    assert (A - B).box == A.box
    assert (A & B).box == A.box.intersect(B.box)
    assert (A | B).box == A.box.hull(B.box)
    assert not (~A).box.finite
    assert (~~A).box == A.box
    assert not (A | ~B).box.finite


def test_box_algebra() -> None:
    box = g.Box((0, 0), (1, 2))
    far = box.intersect(g.Box((3, 3), (4, 4)))
    assert far.empty
    assert box.hull(far) == box
    assert far.hull(box) == box
    assert box.contains(far)
    assert box.contains((1, 1))
    assert not box.contains((1.1, 1))
    assert box.contains((1.1, 1), tolerance=0.2)
    assert box.padded(1.0) == g.Box((-1, -1), (2, 3))
    assert box.corners().shape == (4, 2)
    assert box.center == (0.5, 1.0)
    with pytest.raises(GeometryError, match="dimension"):
        box.hull(g.Box((0, 0, 0), (1, 1, 1)))
    with pytest.raises(GeometryError, match="lower"):
        g.Box((0,), (1, 1))


def test_parts_select_by_prefix() -> None:
    domain = B - A
    assert domain.parts == ("B", "B.left", "B.right", "B.bottom", "B.top", "A")
    assert {s.name for s in domain.part("B").surfaces} == {"B.left", "B.right", "B.bottom", "B.top"}
    assert {s.name for s in domain.part("B.left").surfaces} == {"B.left"}
    assert domain.part("all").surfaces == frozenset(domain.surfaces)


def test_the_same_shape_used_twice_keeps_its_surfaces() -> None:
    domain = (A - B) | (B - A)
    assert len(domain.surfaces) == 5
    assert domain.part("A").surfaces == frozenset(A.surfaces)


def test_unknown_part_lists_parts_and_the_nearest() -> None:
    with pytest.raises(
        GeometryError, match=r"no part 'B\.lft', did you mean 'B\.left'\? \(parts: B, B\.left"
    ):
        (B - A).part("B.lft")


@pytest.mark.parametrize(
    "domain",
    [
        B - g.disk((9, 9), 1).named("far"),
        B | (B & g.disk((0, 0), 5).named("far")),
        B & (g.disk((9, 9), 1).named("far") | B),
        B & ~g.disk((9, 9), 1).named("far"),
    ],
)
def test_eliminated_surfaces_are_no_parts(domain: Shape) -> None:
    assert "far" not in domain.parts
    with pytest.raises(GeometryError, match="no part 'far'"):
        domain.part("far")


def test_touching_shapes_are_not_eliminated() -> None:
    assert "hole" in (B - g.disk((3, 0), 1).named("hole")).parts


@pytest.mark.parametrize("name", ["all", "rest", "a.b", "", "a b"])
def test_bad_names(name: str) -> None:
    with pytest.raises(GeometryError, match="cannot be called"):
        A.named(name)


def test_mixed_dimensions() -> None:
    with pytest.raises(GeometryError, match="dimension 2 and 3"):
        A & g.ball((0, 0, 0), 1)
    with pytest.raises(TypeError, match="only be combined with a shape"):
        A & 3  # type: ignore[operator]


@settings(max_examples=40, deadline=None)
@given(st.floats(-3, 3), st.floats(0.2, 3), st.tuples(st.floats(-2, 2), st.floats(-2, 2)), trees)
def test_motions(angle: float, factor: float, shift: tuple[float, float], tree: object) -> None:
    shape = shape_of(tree)
    moved = shape.rotate(angle, center=(1, 0)).scale(factor).move(shift)
    points = np.random.default_rng(5).uniform(-3, 3, (300, 2))
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    images = ((points - [1, 0]) @ turn.T + [1, 0]) * factor + shift
    clear = np.abs(shape.membership(*points.T)) > 1e-9
    np.testing.assert_array_equal(moved.contains(images[clear]), shape.contains(points[clear]))
    np.testing.assert_allclose(
        moved.membership(*images.T), factor * shape.membership(*points.T), atol=1e-12 * (1 + factor)
    )
    assert moved.parts == shape.parts


def test_rotation_in_space() -> None:
    shape = g.function(lambda x, y, z: x + 0 * y, dimension=3)
    turned = shape.rotate(np.pi / 2, axis=(0, 0, 1)).rotate(np.pi / 2, axis=(1, 0, 0))
    # x -> y -> z
    np.testing.assert_allclose(turned.membership(np.array(3.0), np.array(4.0), np.array(5.0)), 5.0)
    with pytest.raises(GeometryError, match="needs an axis"):
        shape.rotate(1.0)
    with pytest.raises(GeometryError, match="takes no axis"):
        A.rotate(1.0, axis=(0, 0, 1))
    with pytest.raises(GeometryError, match="factor must be positive, got 0"):
        A.scale(0)


def test_moving_keeps_polynomials_sparse() -> None:
    """A moved disk is a disk, not a wrapper; a quarter turn keeps coordinate planes."""
    assert A.move((1, 2)).surfaces[0].function == g.disk((1, 2), 1).surfaces[0].function
    turned = B.rotate(np.pi / 2).surfaces[0]
    assert turned.function.normal == (0.0, 1.0)  # type: ignore[attr-defined]


def test_part_algebra() -> None:
    domain = B - A
    left, right = domain.part("B.left"), domain.part("B.right")
    assert (left | right).surfaces == left.surfaces | right.surfaces
    assert (left | right).where is None
    rest = domain.part("all") - domain.part("B")
    assert rest.surfaces == frozenset(A.surfaces)
    assert not (left - left).surfaces


def test_restricted_parts_join_and_split() -> None:
    domain = A - g.disk((0, 0), 0.5).named("hole")
    points, _ = boundary_points(domain, A.surfaces[0])
    upper = domain.part("A").restricted(lambda x, y: y)
    lower = domain.part("A") - upper
    both = upper | domain.part("hole")
    np.testing.assert_array_equal(upper.selects(points), points[:, 1] > 0)
    np.testing.assert_array_equal(lower.selects(points), points[:, 1] < 0)
    np.testing.assert_array_equal(both.selects(points), points[:, 1] > 0)
    assert len(both.pieces) == 2
    holes, _ = boundary_points(domain, next(iter(domain.part("hole").surfaces)))
    assert both.selects(holes).all()
    assert (upper | domain.part("A")).where is None
    quarter = upper.restricted(lambda x, y: x)
    np.testing.assert_array_equal(quarter.selects(points), (points[:, 1] > 0) & (points[:, 0] > 0))
