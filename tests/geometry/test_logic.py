"""Boolean logic on signs against the expression's own evaluation."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from rfm.geometry import disk, half_plane
from rfm.geometry.logic import Logic
from rfm.geometry.shape import Shape

A, B, C = (disk(center=(x, 0.0), radius=1.0) for x in (0.0, 0.7, 1.3))
H = half_plane(point=(0.0, 0.2), normal=(0.0, 1.0))
SHAPES = {
    "one": A,
    "complement": ~A,
    "flat": A & B - C,
    "union of differences": (A - B) | (C & H),
    "nested": ((A | B) & ~(C & (H | A))) | (B - H),
    "exclusive": A.exclusive(B).exclusive(H),
}


def all_signs(shape: Shape) -> np.ndarray:
    return np.array(list(product((-1, 0, 1), repeat=len(shape.surfaces))), dtype=np.int8)


@pytest.mark.parametrize("name", SHAPES)
def test_values_are_those_of_the_expression(name: str) -> None:
    shape = SHAPES[name]
    signs = all_signs(shape)
    expected = shape.expression.evaluate({s: signs[:, i] for i, s in enumerate(shape.surfaces)})
    found = Logic(shape.expression, shape.surfaces).value(signs)
    np.testing.assert_array_equal(found, expected)
    assert found.dtype == np.int8


@pytest.mark.parametrize("name", SHAPES)
def test_what_does_not_matter_can_be_anything(name: str) -> None:
    shape = SHAPES[name]
    logic, signs = Logic(shape.expression, shape.surfaces), all_signs(shape)
    relevant = logic.relevant(signs)
    value = logic.value(signs)
    assert not relevant[value != 0].any()
    assert not relevant[signs != 0].any()
    assert relevant[value == 0].any(axis=1).all()
    for sign in (-1, 1):
        # An unknown sign that does not matter may be set without a decision being changed.
        np.testing.assert_array_equal(
            logic.value(np.where((signs == 0) & ~relevant, np.int8(sign), signs))[value != 0],
            value[value != 0],
        )


def test_a_decided_term_hides_its_surfaces() -> None:
    shape = (A & H) | B
    logic = Logic(shape.expression, shape.surfaces)
    column = {name: logic.index[part.surfaces[0]] for name, part in (("a", A), ("h", H), ("b", B))}
    signs = np.zeros((1, 3), dtype=np.int8)
    signs[0, column["a"]] = -1
    assert logic.relevant(signs)[0].tolist() == [i == column["b"] for i in range(3)]


@pytest.mark.parametrize("name", SHAPES)
def test_table_holds_all_combinations(name: str) -> None:
    shape = SHAPES[name]
    logic = Logic(shape.expression, shape.surfaces)
    count = len(shape.surfaces)
    signs = np.ones((2, count), dtype=np.int8)
    slots = np.array([np.arange(count), np.arange(count)[::-1]])
    table = logic.table(signs, slots)
    assert table.shape == (2, 2**count)
    for code in range(2**count):
        given = np.array([1 if code >> a & 1 else -1 for a in range(count)], dtype=np.int8)
        assert table[0, code] == (logic.value(given[None])[0] > 0)
        assert table[1, code] == (logic.value(given[None, ::-1])[0] > 0)
