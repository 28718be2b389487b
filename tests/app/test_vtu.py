"""field.vtu is read by others as it was meant."""

import meshio
import numpy as np
import pytest

from rfm.app.samples import sample
from rfm.app.vtu import vtu_bytes
from tests.app.records import ball_minus_cylinder, record, wave


@pytest.fixture(scope="module", params=["plane", "space"])
def written(request, tmp_path_factory):
    made = record() if request.param == "plane" else record(ball_minus_cylinder(), 6)
    samples = sample(made, subcells=24)
    path = tmp_path_factory.mktemp("vtu") / "field.vtu"
    path.write_bytes(vtu_bytes(samples))
    return samples, path


def test_vtk_reads_it(written):
    import pyvista

    samples, path = written
    grid = pyvista.read(path)
    dimension = samples.mesh.dimension
    assert grid.n_points == len(samples.u)
    assert np.array_equal(grid.points[:, :dimension], samples.mesh.points)
    assert np.array_equal(grid.point_data["u"], samples.u)
    assert grid.point_data["gradient"].shape == (len(samples.u), 3)
    sizes = grid.compute_cell_sizes()[{2: "Area", 3: "Volume"}[dimension]]
    assert sizes.min() > 0
    assert sizes.sum() == pytest.approx(samples.mesh.measure)


def test_meshio_reads_it(written):
    _, path = written
    mesh = meshio.read(path)
    exact = wave(*mesh.points.T)
    assert mesh.point_data["u"] == pytest.approx(exact + 1e-6)
    assert mesh.point_data["error"] == pytest.approx(np.full(len(exact), 1e-6))


def test_no_error_without_exact(tmp_path):
    samples = sample(record(exact=None), subcells=10)
    assert samples.error is None
    assert b'Name="error"' not in vtu_bytes(samples)


def test_many_compressed_blocks(tmp_path, monkeypatch):
    import pyvista

    from rfm.app import vtu

    samples = sample(record(), subcells=24)
    size = 8 * len(samples.u)
    for block in (1000, size, size // 2, size - 1):
        monkeypatch.setattr(vtu, "BLOCK", block)
        path = tmp_path / f"{block}.vtu"
        path.write_bytes(vtu_bytes(samples))
        assert np.array_equal(pyvista.read(path).point_data["u"], samples.u)
