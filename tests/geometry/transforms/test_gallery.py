"""The shapes of docs/transforms.md: the code that stands there runs and means what the text says."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np

import rfm.geometry as g
from rfm.geometry import transforms

BLOCKS = re.findall(
    r"```python\n(.*?)```", (Path(__file__).parents[3] / "docs" / "transforms.md").read_text(), re.DOTALL
)


def run(block: str) -> dict[str, Any]:
    names: dict[str, Any] = {"g": g, **{name: getattr(transforms, name) for name in transforms.__all__}}
    exec(block, names)  # the documentation's own code
    return names


def test_the_wheel_has_the_symmetry_of_eight_spokes() -> None:
    wheel = run(BLOCKS[0])["wheel"]
    points = np.random.default_rng(1).uniform(-1.1, 1.1, (4000, 2))
    inside = wheel.contains(points)
    for angle in (np.pi / 4, np.pi / 2):
        c, s = np.cos(angle), np.sin(angle)
        np.testing.assert_array_equal(wheel.contains(points @ np.array([[c, s], [-s, c]])), inside)
    np.testing.assert_array_equal(wheel.contains(points * [1, -1]), inside)
    assert wheel.contains(np.array([[0.5, 0.0], [0.9, 0.1], [0.2, 0.05]])).all()
    assert not wheel.contains(np.array([[0.5, 0.2], [0.0, 0.0], [1.05, 0.0]])).any()


def test_the_pawn_is_short_and_round() -> None:
    assert len(BLOCKS[1].strip().splitlines()) == 5
    pawn = run(BLOCKS[1])["pawn"]
    points = np.random.default_rng(2).uniform((-1.2, -1.2, -0.1), (1.2, 1.2, 2.7), (4000, 3))
    turned = np.column_stack([np.hypot(points[:, 0], points[:, 1]), 0.0 * points[:, 0], points[:, 2]])
    np.testing.assert_array_equal(pawn.contains(points), pawn.contains(turned))
    assert pawn.contains(
        np.array([[0.0, 0.0, 0.1], [0.0, 0.0, 1.0], [0.3, 0.0, 2.2], [1.05, 0.0, 0.125]])
    ).all()
    np.testing.assert_allclose(pawn.box.upper, [1.125, 1.125, 2.52], atol=1e-9)
    np.testing.assert_allclose(pawn.box.lower, [-1.125, -1.125, 0.0], atol=1e-9)
    rest = [surface for surface in pawn.surfaces if surface.degree is None]
    assert len(rest) == 1, "the groove alone is no polynomial"
