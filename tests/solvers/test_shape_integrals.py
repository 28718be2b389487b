"""Integrals of shapes and their derivatives against closed forms and differences."""

from __future__ import annotations

import numpy as np
import pytest

from rfm.errors import GeometryError
from rfm.geometry import Shape, ball, box, cylinder, disk, ellipse, half_plane, rectangle, torus
from solvers.shape_integrals.properties import properties
from solvers.shape_integrals.sensitivity import sensitivity


def test_a_rectangle():
    found = properties(rectangle((1, 2), (4, 4)))
    assert found.volume == pytest.approx(6, abs=1e-12)
    assert found.surface == pytest.approx(10, abs=1e-12)
    assert found.surfaces["left"] == pytest.approx(2, abs=1e-12)
    assert found.centroid == pytest.approx([2.5, 3], abs=1e-12)
    np.testing.assert_allclose(found.moments, np.diag([2 * 27 / 12, 3 * 8 / 12]), atol=1e-11)


def test_an_ellipse_turned():
    found = properties(ellipse((0.3, -0.2), (1.0, 0.5), np.pi / 6))
    turn = np.array([[np.cos(np.pi / 6), -0.5], [0.5, np.cos(np.pi / 6)]])
    moments = turn @ np.diag([np.pi * 0.5 / 4, np.pi * 0.125 / 4]) @ turn.T
    assert found.volume == pytest.approx(np.pi / 2, rel=1e-11)
    np.testing.assert_allclose(found.moments, moments, atol=1e-11)


def test_solids():
    ring = properties(torus((0, 0, 0), (0, 0, 1), 1.0, 0.4))
    assert ring.volume == pytest.approx(2 * np.pi**2 * 0.16, rel=1e-8)
    assert ring.surface == pytest.approx(4 * np.pi**2 * 0.4, rel=1e-7)
    bead = properties(ball((0, 0, 0), 1) - cylinder((0, 0, 0), (0, 0, 1), 0.6))
    assert bead.volume == pytest.approx(4 / 3 * np.pi * 0.8**3, rel=1e-9)
    assert bead.surface == pytest.approx(4 * np.pi * 0.8 + 4 * np.pi * 0.6 * 0.8, rel=1e-9)
    solid = properties(ball((0.1, 0.2, 0.3), 0.5))
    np.testing.assert_allclose(solid.inertia, 0.4 * solid.volume * 0.25 * np.eye(3), atol=1e-9)


def test_the_derivative_of_an_annulus():
    found = sensitivity(lambda r: disk((0.2, 0.1), 1.0) - disk((0.2, 0.1), r), 0.3)
    assert found.volume == pytest.approx(-2 * np.pi * 0.3, rel=1e-10)
    assert found.surface == pytest.approx(2 * np.pi, rel=1e-10)
    assert found.centroid == pytest.approx([0, 0], abs=1e-11)
    np.testing.assert_allclose(found.inertia, np.diag([-np.pi * 0.027] * 2), atol=1e-10)


def test_a_segment_of_a_disk():
    """Cut off at height t: area arccos t - t sqrt(1 - t^2), boundary 2 arccos t + 2 sqrt(1 - t^2)."""
    found = sensitivity(lambda t: disk((0, 0), 1) & half_plane((0, t), (0, 1)), 0.3)
    root = np.sqrt(1 - 0.09)
    assert found.volume == pytest.approx(-2 * root, rel=1e-10)
    assert found.surface == pytest.approx(-2 / root - 0.6 / root, rel=1e-9)


def test_a_corner_that_slides_along_an_edge():
    """A square with its top right corner cut along x + y = t."""

    def family(t: float) -> Shape:
        return rectangle((0, 0), (1, 1)) & half_plane((t / 2, t / 2), (-1, -1))

    found = sensitivity(family, 1.6)
    assert found.volume == pytest.approx(2 - 1.6, rel=1e-10)
    assert found.surface == pytest.approx(2 - np.sqrt(2), rel=1e-10)


FAMILIES = {
    "union": (lambda t: disk((0, 0), 1) | rectangle((0, -0.4), (1.2 + t, 0.3 + 0.2 * t)), 0.2),
    "hole at an edge": (lambda t: rectangle((0, 0), (2, 1)) - disk((1, 0.9), t), 0.4),
    "bore": (lambda t: ball((0, 0, 0), 1) - cylinder((0, 0, 0), (0, 0, 1), t), 0.4),
    "notch": (lambda t: box((0, 0, 0), (1, 1, 1)) - ball((1, 1, 1), t), 0.5),
}


@pytest.mark.parametrize("name", FAMILIES)
def test_derivatives_agree_with_differences(name):
    family, at = FAMILIES[name]
    found, step = sensitivity(family, at), 1e-3
    sides = [properties(family(at + side * step)) for side in (-2, -1, 1, 2)]
    for key in ("volume", "surface", "centroid", "moments", "inertia"):
        a, b, c, d = (np.asarray(getattr(side, key)) for side in sides)
        difference = (a - 8 * b + 8 * c - d) / (12 * step)
        np.testing.assert_allclose(getattr(found, key), difference, atol=2e-6, err_msg=key)


def test_refusals():
    with pytest.raises(GeometryError, match="only a bounded shape has a volume"):
        properties(half_plane((0, 0), (1, 0)))
    with pytest.raises(GeometryError, match="other surfaces at the parameter"):
        sensitivity(lambda t: disk((0, 0), 1) if t > 0.5 else rectangle((0, 0), (1, 1)), 0.5)
