"""Fast evaluation gives what plain evaluation gives, whatever the shape, the points and the threads."""

from __future__ import annotations

import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from random_polygons import random_polygon

import rfm.geometry as g
from rfm.calculus import R0, R1, Rp, partials
from rfm.calculus.types import Field
from rfm.errors import GeometryError
from rfm.geometry.pruning import prune
from rfm.geometry.sampled import sample
from rfm.geometry.vanishing import Composition


def composition(shape: g.Shape, system: object) -> Field:
    return Composition(shape.expression, system, lambda surface: surface.function)  # type: ignore[arg-type]


def random_solid(operations: int, random: np.random.Generator) -> g.Shape:
    """Balls, boxes and cylinders, added and taken away."""
    shape = g.box((-1, -1, -1), (1, 1, 1))
    for step in range(operations):
        center, size = random.uniform(-1, 1, 3), float(random.uniform(0.1, 0.4))
        kind = random.integers(3)
        if kind == 0:
            other = g.ball(center, size)
        elif kind == 1:
            other = g.box(center - size, center + random.uniform(0.1, 0.4, 3))
        else:
            other = g.cylinder(center, random.normal(size=3), size, height=2 * size)
        shape = shape | other if step % 2 else shape - other
    return shape


@settings(max_examples=15)
@given(st.integers(3, 120), st.integers(0, 1000), st.integers(0, 2), st.sampled_from([1, 2]))
def test_polygons(count: int, seed: int, order: int, threads: int) -> None:
    random = np.random.default_rng(seed)
    shape = g.polygon(random_polygon(count, random))
    points = np.concatenate([random.uniform(-0.5, 1.5, (3000, 2)), random.normal(0.5, 0.01, (500, 2))])
    for field in (shape.membership, composition(shape, R1())):
        np.testing.assert_array_equal(sample(field, points, order, threads), partials(field, points.T, order))
    field = composition(shape, R0)
    expected = partials(field, points.T, order)
    np.testing.assert_allclose(
        sample(field, points, order, threads), expected, rtol=1e-10, atol=1e-12 * np.abs(expected).max()
    )


@pytest.mark.parametrize("system", [R0, R1(), Rp(4)])
@pytest.mark.parametrize("order", [0, 1])
def test_solids(system: object, order: int) -> None:
    random = np.random.default_rng(5)
    shape = random_solid(12, random)
    points = random.uniform(-1.3, 1.3, (9000, 3))
    field = composition(shape, system)
    np.testing.assert_allclose(sample(field, points, order, 2), partials(field, points.T, order), atol=1e-11)


@pytest.mark.parametrize("order", [0, 1, 2])
def test_every_operation_keeps_its_system(order: int) -> None:
    points = np.random.default_rng(0).uniform(-1, 2, (3000, 2))
    square, disk, strip = g.rectangle((0, 0), (1, 1)), g.disk((1, 1), 0.6), g.strip((0.2, 0), (1, 1), 0.3)
    for shape in (square.using("r0") - disk, square | disk.using("rp4"), (square | disk).using("r0") & strip):
        expected = partials(shape.membership, points.T, order)
        np.testing.assert_allclose(sample(shape, points, order), expected, rtol=1e-9, atol=1e-9)


def test_any_field() -> None:
    points = np.random.default_rng(0).uniform(-1, 1, (20_000, 2))
    shape = g.disk((0, 0), 1) - g.disk((0, 0), 0.5)
    weight = g.weight(shape, shape.part("all"))
    np.testing.assert_array_equal(sample(weight, points, 2, 2), partials(weight, points.T, 2))


def test_where_both_functions_of_a_pair_vanish() -> None:
    shape = g.rectangle((0, 0), (1, 1))
    points = np.array([(0.0, 0.0), (1.0, 0.0), (0.5, 0.5)])
    field = composition(shape, R0)
    np.testing.assert_array_equal(sample(field, points), partials(field, points.T, 1))
    assert np.isfinite(sample(field, points)).all()


def test_little_is_left_of_a_large_polygon() -> None:
    random = np.random.default_rng(0)
    shape = g.polygon(random_polygon(200, random))
    points = random.uniform(0, 1, (100_000, 2))
    sets = prune(shape.expression, lambda surface: surface.function, points)
    assert sorted(np.concatenate([chosen for _, chosen in sets]).tolist()) == list(range(len(points)))
    left = sum(len(rest.literals()) * len(chosen) for rest, chosen in sets) / len(points)
    assert left < 12


@pytest.mark.parametrize("points", [np.zeros((0, 2)), np.full((50, 2), 0.3), np.array([[0.3, 0.1]])])
def test_few_points(points: np.ndarray) -> None:
    shape = g.polygon([(0, 0), (1, 0), (0.4, 0.3), (0, 1)])
    np.testing.assert_array_equal(sample(shape, points, 1), partials(shape.membership, points.T, 1))


def test_the_default_number_of_threads_obeys_the_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    from rfm.geometry import sampled

    used: list[int] = []
    pool = sampled.ThreadPoolExecutor
    monkeypatch.setattr(sampled, "ThreadPoolExecutor", lambda workers: used.append(workers) or pool(workers))
    monkeypatch.setattr(sampled.os, "sched_getaffinity", lambda pid: set(range(8)), raising=False)
    for limit in ("3", "1", ""):
        monkeypatch.setenv("OMP_NUM_THREADS", limit)
        sample(g.disk((0, 0), 1), np.zeros((5, 2)))
    assert used == [3, 8]


@pytest.mark.parametrize(
    ("points", "threads", "message"),
    [
        (np.zeros((4, 3)), 1, "points must be an array (n, 2), got shape (4, 3)"),
        (np.zeros(4), 1, "points must be an array (n, 2), got shape (4,)"),
        (np.array([[0.0, np.nan]]), 1, "points must be finite"),
        (np.zeros((4, 2)), 0, "threads must be at least 1, got 0"),
    ],
)
def test_refused(points: np.ndarray, threads: int, message: str) -> None:
    with pytest.raises(GeometryError, match=re.escape(message)):
        sample(g.disk((0, 0), 1), points, threads=threads)
