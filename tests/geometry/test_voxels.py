"""Functional voxels: characteristics, algebra, images, reconstruction."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from rfm.calculus import R0, exp, sin, system
from rfm.errors import GeometryError
from rfm.geometry import Box, ball, cylinder, disk, half_plane, slab
from rfm.geometry.voxels import (
    complement,
    intersection,
    read_images,
    union,
    value_at,
    voxels,
    write_images,
    zero_points,
)
from rfm.geometry.voxels.images import accuracy

SQUARE = Box((-1.5, -1.0), (1.5, 1.2))
CUBE = Box((-1, -1, -1), (1, 1, 1))
SKEW = Box((-1.01, -0.93, -1.07), (1.03, 1.0, 0.98))


def circle(x, y):
    return 1 - x * x - y * y


def waves(x, y):
    return sin(2 * x) * exp(0.3 * y) - 0.2


def tube(x, y, z):
    return 0.5 - x * x - z * z + 0.0 * y


def layer(x, y, z):
    return 0.25 - (0.6 * x + 0.8 * z) ** 2 + 0.0 * y


@pytest.mark.parametrize("field", [circle, waves])
def test_the_characteristics_are_the_unit_normal_of_the_graph(field):
    model = voxels(field, SQUARE, (31, 21), scale=1.0)
    assert model.characteristics.shape == (4, 31, 21)
    np.testing.assert_allclose((model.characteristics**2).sum(axis=0), 1.0, atol=1e-14)
    np.testing.assert_allclose(model.values, field(*model.nodes), atol=1e-13)
    assert (model.characteristics[-2] < 0).all()


def test_slopes_come_back():
    model = voxels(circle, SQUARE, (11, 11))
    x, y = model.nodes
    np.testing.assert_allclose(model.slopes, np.stack([-2 * x, -2 * y]), atol=1e-12)


@pytest.mark.parametrize("name", ["r0", "ralpha0.3", "rp4", "r0m1"])
def test_operations_on_characteristics_are_those_on_functions(name):
    chosen = system(name)
    first, second = voxels(circle, SQUARE, (30, 20)), voxels(waves, SQUARE, (30, 20))
    for combined, operation in ((intersection, chosen.conjunction), (union, chosen.disjunction)):
        model = combined(first, second, chosen)
        direct = voxels(
            lambda x, y, op=operation: op(circle(x, y), waves(x, y)), SQUARE, (30, 20), model.scale
        )
        np.testing.assert_allclose(model.characteristics, direct.characteristics, atol=1e-12)


@given(st.floats(-1, 1), st.floats(-1, 1), st.floats(0.1, 1))
def test_the_complement_of_the_complement_is_the_model(x0, y0, radius):
    model = voxels(disk((x0, y0), radius).membership, SQUARE, (7, 6))
    np.testing.assert_array_equal(complement(complement(model)).characteristics, model.characteristics)
    np.testing.assert_allclose(complement(model).values, -model.values, atol=1e-13)


@pytest.mark.parametrize(("kind", "bound"), [("rgb", 2e-6), ("grey", 2e-1)])
@pytest.mark.parametrize(("field", "box", "counts"), [(circle, SQUARE, (40, 30)), (tube, CUBE, (9, 8, 7))])
def test_images_are_read_back_within_the_stated_accuracy(tmp_path, kind, bound, field, box, counts):
    model = voxels(field, box, counts)
    paths = write_images(model, tmp_path, "model", kind)
    assert [p.name for p in paths] == [f"model-{i + 1}.png" for i in range(box.dimension + 2)]
    read = read_images(tmp_path, "model")
    assert (read.box, read.counts, read.scale) == (model.box, model.counts, model.scale)
    error, stated = np.abs(read.values - model.values), accuracy(model, kind)
    assert (error <= 1.05 * stated + 1e-12).all()
    assert error.max() < bound
    with Image.open(paths[0]) as picture:
        assert picture.mode == {"rgb": "RGB", "grey": "L"}[kind]


def test_the_picture_of_a_half_plane_is_of_one_colour(tmp_path):
    model = voxels(half_plane((0, 0), (1, 0)).membership, Box((-1, -1), (1, 1)), (8, 8))
    (first, *_) = write_images(model, tmp_path, "half", "grey")
    with Image.open(first) as picture:
        assert len(set(picture.getdata())) == 1


@pytest.mark.parametrize(
    ("field", "box", "distance"),
    [
        (circle, SQUARE, lambda p: np.linalg.norm(p, axis=1) - 1),
        (tube, SKEW, lambda p: np.hypot(p[:, 0], p[:, 2]) - np.sqrt(0.5)),
        (layer, SKEW, lambda p: np.abs(p @ (0.6, 0, 0.8)) - 0.5),
    ],
    ids=["circle", "cylinder", "slab"],
)
def test_the_zero_set_is_of_second_order(field, box, distance):
    errors, counts = [], (13, 24, 43, 60)
    for count in counts:
        points, normals = zero_points(voxels(field, box, (count,) * box.dimension))
        assert len(points) > count
        np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0)
        errors.append(np.sqrt(np.mean(distance(points) ** 2)))
    order = -np.polyfit(np.log(counts), np.log(errors), 1)[0]
    assert 1.8 < order < 2.4, (order, errors)


def test_the_zero_set_survives_24_bits(tmp_path):
    model = voxels(circle, SQUARE, (101, 101))
    write_images(model, tmp_path, "circle")
    points, _ = zero_points(read_images(tmp_path, "circle"))
    exact, _ = zero_points(model)
    assert len(points) == len(exact)
    assert np.abs(points - exact).max() < 1e-5


def test_values_between_the_nodes_are_of_second_order():
    points = np.random.default_rng(3).uniform((-1.5, -1.0), (1.5, 1.2), (500, 2))
    errors = [
        np.abs(value_at(voxels(waves, SQUARE, (n, n)), points) - waves(*points.T)).max() for n in (21, 41, 81)
    ]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert (orders > 1.7).all(), (orders, errors)


def test_a_lens_from_models_alone():
    first = voxels(disk((-0.4, 0), 1).membership, SQUARE, (201, 201))
    second = voxels(disk((0.4, 0), 1).membership, SQUARE, (201, 201))
    points, _ = zero_points(intersection(first, second, R0))
    reach = np.maximum(np.hypot(points[:, 0] + 0.4, points[:, 1]), np.hypot(points[:, 0] - 0.4, points[:, 1]))
    assert np.percentile(np.abs(reach - 1), 98) < 1e-3


def test_refusals(tmp_path):
    with pytest.raises(GeometryError, match=r"a voxel model needs 2 counts of at least 2, got \[1, 5\]"):
        voxels(circle, SQUARE, (1, 5))
    with pytest.raises(GeometryError, match="needs a finite box"):
        voxels(circle, Box((0, 0), (np.inf, 1)), (4, 4))
    with pytest.raises(GeometryError, match=r"not finite at \[0\.0, 0\.0\]"):
        voxels(lambda x, y: (x * x + y * y) ** 0.5, Box((-1, -1), (1, 1)), (3, 3))
    with pytest.raises(GeometryError, match="the models have different lattices"):
        union(voxels(circle, SQUARE, (4, 4)), voxels(circle, SQUARE, (5, 4)))
    with pytest.raises(GeometryError, match="unknown kind of image 'blue'; choose one of rgb, grey"):
        write_images(voxels(circle, SQUARE, (4, 4)), tmp_path, "a", "blue")
    with pytest.raises(GeometryError, match="cannot be read as an image"):
        read_images(tmp_path, "nothing")
    Image.new("L", (4, 4)).save(tmp_path / "plain-1.png")
    with pytest.raises(GeometryError, match="is no M-image"):
        read_images(tmp_path, "plain")
    with pytest.raises(GeometryError, match="lies outside the model's box"):
        value_at(voxels(circle, SQUARE, (4, 4)), np.array([[9.0, 0.0]]))


def test_shapes_of_the_library_have_models():
    for shape, box in (
        (ball((0, 0, 0), 0.8), CUBE),
        (cylinder((0, 0, 0), (0, 0, 1), 0.5), CUBE),
        (slab((0, 0, 0), (1, 0, 0), 0.5), CUBE),
    ):
        model = voxels(shape.membership, box, (9, 9, 9))
        inside = shape.contains(np.stack([x.ravel() for x in model.nodes], axis=1)).reshape(model.counts)
        np.testing.assert_array_equal(model.values > 1e-12, inside)
