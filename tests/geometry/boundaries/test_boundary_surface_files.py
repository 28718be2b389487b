from __future__ import annotations

import re

import meshio
import numpy as np
import pytest

from rfm.errors import GeometryError
from rfm.geometry.boundaries import read_surface, signed_surface, surface

CUBE = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
QUADS = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])
TRIANGLES = np.concatenate([QUADS[:, [0, 1, 2]], QUADS[:, [0, 2, 3]]])


@pytest.mark.parametrize("suffix", ["stl", "ply", "obj", "vtk"])
def test_triangles_of_a_file(tmp_path, suffix):
    file = tmp_path / f"cube.{suffix}"
    meshio.Mesh(CUBE, [("triangle", TRIANGLES)]).write(file)
    w = signed_surface(surface(*read_surface(file)))
    x = np.random.default_rng(0).uniform(-0.5, 1.5, (3, 500))
    np.testing.assert_array_equal(w(*x) > 0.0, ((x > 0) & (x < 1)).all(axis=0))


def test_quadrilaterals_are_cut(tmp_path):
    meshio.Mesh(CUBE, [("quad", QUADS)]).write(tmp_path / "cube.vtk")
    vertices, triangles = read_surface(tmp_path / "cube.vtk")
    assert len(triangles) == 12
    assert signed_surface(surface(vertices, triangles))(0.5, 0.5, 0.5) > 0.0


def test_bad_files(tmp_path, capsys):
    def refused(name, message):
        with pytest.raises(GeometryError, match=f"^{re.escape(message)}"):
            read_surface(tmp_path / name)

    refused("none.stl", f"there is no file {tmp_path / 'none.stl'}")
    (tmp_path / "text.vtk").write_text("no mesh")
    refused("text.vtk", f"{tmp_path / 'text.vtk'} cannot be read as a triangulated surface")
    (tmp_path / "shape.xyz").write_text("0 0 0")
    refused(
        "shape.xyz", f"{tmp_path / 'shape.xyz'} cannot be read as a triangulated surface: Could not deduce"
    )
    meshio.Mesh(CUBE, [("line", [[0, 1]])]).write(tmp_path / "line.vtk")
    refused("line.vtk", f"{tmp_path / 'line.vtk'} has no triangles in space")
    assert capsys.readouterr().out == ""
