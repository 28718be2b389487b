"""Triangulated surfaces from files: STL, PLY, OBJ, OFF, VTK, VTU, Gmsh and whatever else meshio reads."""

from __future__ import annotations

import contextlib
import io
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from rfm.calculus.types import Array
from rfm.errors import GeometryError


def read_surface(path: str | Path) -> tuple[Array, NDArray[np.intp]]:
    """Vertices (m, 3) and triangles (n, 3) of a file; quadrilaterals are cut in two.

    Other cells, the inside of a solid mesh for instance, are passed over.  The result suits
    :func:`rfm.geometry.boundaries.surface`.

    Raises
    ------
    GeometryError
        When the file cannot be read or has no triangles in space.
    """
    import meshio

    file = Path(path)
    if not file.is_file():
        raise GeometryError(f"there is no file {file}")
    try:
        # meshio writes what it tries to the standard output, and leaves the program when nothing helps
        quiet = contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO())
        with quiet[0], quiet[1], np.errstate(over="ignore"):
            mesh = meshio.read(file)
    except (Exception, SystemExit) as error:
        reason = f": {error}" if isinstance(error, meshio.ReadError) else ""
        raise GeometryError(f"{file} cannot be read as a triangulated surface{reason}") from None
    cells = [np.asarray(block.data, dtype=np.intp) for block in mesh.cells if block.type == "triangle"]
    for block in mesh.cells:
        if block.type == "quad":
            quads = np.asarray(block.data, dtype=np.intp)
            cells += [quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]
    vertices = np.asarray(mesh.points, dtype=np.float64)
    if not cells or vertices.shape[1] != 3:
        raise GeometryError(f"{file} has no triangles in space")
    return vertices, np.concatenate(cells)
