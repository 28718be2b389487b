"""The fitted mesh: its measure, its points on the boundary, its corners, its conformity."""

import math

import numpy as np
import pytest

from rfm.app.fitted import fit
from rfm.app.fitted.lattice import kuhn_simplices
from rfm.app.fitted.mesh import volumes
from rfm.geometry.primitives_2d import disk, rectangle
from rfm.geometry.primitives_3d import ball, box, torus
from solvers.classify import classify
from solvers.grid import Grid
from tests.app.records import annulus, ball_minus_cylinder


def fitted(shape, cells=10, subcells=None):
    grid = Grid.cover(shape.box, cells)
    return fit(shape, grid, classify(shape, grid), subcells)


def lens():
    return disk((0, 0), 1).named("disk") & rectangle((-0.2, -0.3), (2, 0.6)).named("plate")


SHAPES = {
    "annulus": (annulus, 0.15 * math.pi),
    "lens": (lens, None),
    "union": (lambda: disk((0, 0), 1).named("a") | disk((1.2, 0.3), 0.7).named("b"), None),
    "ball minus cylinder": (ball_minus_cylinder, 4 / 3 * math.pi * 0.91**1.5),
    "torus": (
        lambda: torus((0, 0, 0), (0, 0, 1), 0.7, 0.25).named("torus"),
        2 * math.pi**2 * 0.7 * 0.0625,
    ),
    "box minus ball": (
        lambda: box((0, 0, 0), (1, 1, 1)).named("box") - ball((1, 1, 1), 0.6).named("ball"),
        1 - math.pi * 0.6**3 / 6,
    ),
}


@pytest.mark.parametrize("dimension", [1, 2, 3])
def test_kuhn_simplices_fill_the_cube_with_positive_volumes(dimension):
    corners = np.array(np.meshgrid(*[[0.0, 1.0]] * dimension, indexing="ij")).reshape(dimension, -1).T
    size = volumes(corners, kuhn_simplices(dimension))
    assert size.min() > 0
    assert size.sum() == pytest.approx(1)


@pytest.mark.parametrize("name", SHAPES)
def test_measure_boundary_and_orientation(name):
    make, measure = SHAPES[name]
    shape = make()
    mesh = fitted(shape)
    edge = mesh.points[np.unique(mesh.facets)]
    assert np.abs(shape.membership(*edge.T)).max() < 1e-12
    assert volumes(mesh.points, mesh.all_simplices).min() > 0
    if measure is not None:
        assert mesh.measure == pytest.approx(measure, rel=4e-3)
    assert flux(mesh) == pytest.approx(mesh.measure, rel=1e-3)
    middles = mesh.points[mesh.all_simplices].mean(axis=1)
    assert (shape.membership(*middles.T) > -1e-3).all()


def flux(mesh):
    """Flux of x/d through the boundary facets: the measure, when they are closed and face outward."""
    corners = mesh.points[mesh.facets]
    if mesh.dimension == 2:
        along = corners[:, 1] - corners[:, 0]
        normal = np.stack([along[:, 1], -along[:, 0]], axis=1)
    else:
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2
    return float((corners.mean(axis=1) * normal).sum()) / mesh.dimension


def test_the_measure_converges_with_second_order():
    errors = [1 - fitted(disk((0, 0), 1).named("d"), 10, n).measure / math.pi for n in (20, 40, 80, 160)]
    assert math.log2(errors[0] / errors[-1]) / 3 == pytest.approx(2, abs=0.15)


def test_corners_are_points_of_the_mesh():
    mesh = fitted(lens(), 7)
    corners = [(-0.2, -0.3), (-0.2, 0.6), (0.8, 0.6), (math.sqrt(0.91), -0.3)]
    for corner in corners:
        assert np.linalg.norm(mesh.points - corner, axis=1).min() < 1e-12


def test_the_boundary_of_a_plane_shape_is_closed():
    mesh = fitted(annulus())
    counts = np.bincount(mesh.facets.ravel(), minlength=len(mesh.points))
    assert set(counts) == {0, 2}
    starts, ends = (np.bincount(column, minlength=len(counts)) for column in mesh.facets.T)
    assert np.array_equal(starts, ends)


def test_a_boundary_aligned_with_the_grid():
    mesh = fitted(rectangle((0, 0), (2, 1)).named("plate"), 8, 8)
    assert len(mesh.facets) == 24
    assert {mesh.surfaces[k].name for k in mesh.carriers} == {
        "plate.left",
        "plate.right",
        "plate.bottom",
        "plate.top",
    }
    assert mesh.measure == pytest.approx(2, rel=1e-14)


def test_a_hole_smaller_than_a_subcell_is_seen():
    shape = rectangle((0, 0), (1, 1)).named("plate") - disk((0.52, 0.47), 0.004).named("hole")
    mesh = fitted(shape, 8, 32)
    assert any(mesh.surfaces[k].name == "hole" for k in mesh.carriers)
    assert 1 - mesh.measure == pytest.approx(math.pi * 0.004**2, rel=0.2)


@pytest.mark.parametrize("gap", [1e-1, 1e-3, 1e-6, 1e-9, 1e-12])
def test_slivers_do_no_harm(gap):
    mesh = fitted(rectangle((gap, gap), (1, 1)).named("plate") & disk((0, 0), 0.9).named("disk"), 8)
    assert np.isfinite(mesh.points).all()
    assert flux(mesh) == pytest.approx(mesh.measure, rel=1e-3)


@pytest.mark.parametrize("sliver", [1e-1, 1e-3, 1e-6, 1e-9, 1e-12])
def test_the_boundary_beyond_a_sliver_is_found(sliver):
    shape = rectangle((0, 0), (1 + sliver, 1)).named("plate")
    grid = Grid.with_spacing(shape.box, 0.125)
    mesh = fit(shape, grid, classify(shape, grid), 16)
    assert mesh.measure == pytest.approx(1 + sliver, rel=1e-12)
    assert flux(mesh) == pytest.approx(1 + sliver, rel=1e-12)


def test_tangent_circles():
    shape = disk((0, 0), 1).named("a") - disk((0.5, 0), 0.5).named("b")
    mesh = fitted(shape, 12)
    assert np.isfinite(mesh.points).all()
    assert mesh.measure == pytest.approx(0.75 * math.pi, rel=1e-3)
