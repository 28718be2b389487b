"""Pictures: right colours in the right places, any title, no display, no global state."""

import io
import sys

import matplotlib.image
import numpy as np
import pytest

from rfm.app.pictures import Gallery, solution_figure
from rfm.app.pictures.canvas import limits, short_number
from rfm.app.pictures.convergence import convergence
from rfm.app.pictures.parts import named_facets
from rfm.app.pictures.render import Camera, look
from rfm.app.pictures.slices import section
from rfm.app.samples import sample
from rfm.geometry.primitives_2d import rectangle
from tests.app.records import STUDY, ball_minus_cylinder, record


def gallery(made, subcells=20):
    return Gallery(made, sample(made, subcells))


def pixels(png):
    return matplotlib.image.imread(io.BytesIO(png), format="png")


@pytest.fixture(scope="module")
def plane():
    return gallery(record())


@pytest.fixture(scope="module")
def space():
    return gallery(record(ball_minus_cylinder(), 6))


@pytest.mark.parametrize("name", ["solution", "error", "shape"])
@pytest.mark.parametrize("kind", ["plane", "space"])
def test_pictures_are_drawn(kind, name, request):
    image = pixels(getattr(request.getfixturevalue(kind), name))
    assert min(image.shape[:2]) > 300
    assert image[..., :3].std() > 0.05


def test_pictures_need_no_global_state(plane):
    assert plane.solution
    assert "matplotlib.pyplot" not in sys.modules or not sys.modules["matplotlib.pyplot"].get_fignums()


def test_the_same_run_gives_the_same_picture():
    first, second = (gallery(record()).solution for _ in range(2))
    assert np.array_equal(pixels(first), pixels(second))


def test_no_error_picture_without_exact():
    assert gallery(record(exact=None)).error is None


def test_a_constant_and_a_broken_field_are_drawn():
    for value in (0.0, 2.5, np.nan):
        made = record(u=lambda points, value=value: np.full(len(points), value))
        assert gallery(made).solution


def test_figure_for_notebooks():
    made = record()
    assert solution_figure(made, sample(made, 12)).get_axes()


def test_parts_have_their_names():
    made = record(rectangle((0, 0), (1, 1)).named("plate"), 4)
    parts = named_facets(sample(made, 8).mesh)
    assert set(parts.names) == {"plate.left", "plate.right", "plate.bottom", "plate.top"}
    assert set(np.bincount(parts.number)) == {8}


def test_convergence_leaves_out_what_is_missing():
    assert convergence((), "nothing") is None
    rows = [*STUDY, {"degree": 3, "grid": 8, "dofs": 1, "relative_l2_error": None}]
    figure = convergence(rows, "one kind of error")
    assert len(figure.get_axes()) == 1
    assert len(figure.get_axes()[0].get_legend().get_texts()) == 2


def test_limits_of_colours():
    assert limits(np.array([1.0, 3.0, np.nan])) == (1.0, 3.0)
    assert limits(np.array([-1.0, 3.0]), symmetric=True) == (-3.0, 3.0)
    for values in ([0.0, 0.0], [5.0], [np.nan], []):
        low, high = limits(np.array(values))
        assert low < high


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.0, "0"), (1.24e-9, "1.2e-9"), (0.5, "0.5"), (123456.0, "1.2e5"), (-2e-5, "-2.0e-5")],
)
def test_short_numbers(value, text):
    assert short_number(value) == text


def test_the_nearer_of_two_triangles_is_seen():
    low = np.array([[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0]])
    corners = np.stack([low, 0.5 * low + [0, 0, 1], low - [0, 0, 1]])
    normals = np.broadcast_to([0.0, 0.0, 1.0], corners.shape).copy()
    view = look(corners, normals, Camera.around(corners.reshape(-1, 3), -90.0, 90.0), 100)
    assert set(view.owner) == {0, 1}
    share = (view.owner == 1).mean()
    assert share == pytest.approx(0.25, abs=0.02)
    assert view.shares.min() > -1e-9
    assert view.shares.sum(axis=1) == pytest.approx(np.ones(len(view.owner)))


def test_triangles_that_face_away_are_not_seen():
    corners = np.array([[[-1.0, -1.0, 0.0], [0.0, 1.0, 0.0], [1.0, -1.0, 0.0]]])
    view = look(corners, np.ones_like(corners), Camera.around(corners[0], -90.0, 90.0), 50)
    assert len(view.owner) == 0


def test_the_area_of_a_ball_on_the_screen(space):
    solid = space._painter._solid
    height, width = solid.view.shape
    margin = 1.06
    assert len(solid.view.owner) / (width * height) == pytest.approx(np.pi / 4 / margin**2, rel=0.01)


def test_a_section_knows_the_inside():
    shape = ball_minus_cylinder()
    plane = section(shape, -np.ones(3), np.ones(3), np.zeros(3), (0, 1, 2))
    spacing = (plane.ticks[0][1] - plane.ticks[0][0]) * (plane.ticks[1][1] - plane.ticks[1][0])
    assert (plane.membership > 0).sum() * spacing == pytest.approx(np.pi * 0.91, rel=0.02)
    values = plane.sampled(lambda points: points[:, 0])
    inside = plane.membership > 0
    assert np.array_equal(values[inside], plane.points[inside][:, 0])
    assert np.isfinite(values).sum() > inside.sum()
