"""``field.vtu``: the field on the fitted mesh as a VTK unstructured grid, for ParaView and pyvista.

The XML format of VTK, written directly (it takes a second to load the VTK library, and none of it is
needed): arrays inline in base64, compressed by zlib in blocks, preceded by the header
``number of blocks, size of a block, size of the last one if partial, compressed sizes`` in UInt64
(https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html).
"""

from __future__ import annotations

import base64
import sys
import zlib
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rfm.app.samples import Samples
from rfm.calculus.types import Array

BLOCK = 1 << 20
"""Bytes compressed together."""

BLOCK_CELLS = {1: (3, (0, 1)), 2: (9, (0, 2, 3, 1)), 3: (12, (0, 4, 6, 2, 1, 5, 7, 3))}
"""VTK type of a subcell by dimension (line, quad, hexahedron) and VTK's order of its corners."""

SIMPLEX_CELLS = {1: 3, 2: 5, 3: 10}
"""VTK type of a simplex by dimension (line, triangle, tetrahedron)."""

VTK_TYPES = {"f8": "Float64", "i4": "Int32", "i8": "Int64", "u1": "UInt8"}


def vtu_bytes(samples: Samples) -> bytes:
    """Content of ``field.vtu``: point data u, gradient, derived quantities and, when known, error."""
    mesh = samples.mesh
    kind, order = BLOCK_CELLS[mesh.dimension]
    cells = [(kind, mesh.blocks[:, list(order)]), (SIMPLEX_CELLS[mesh.dimension], mesh.simplices)]
    sizes = np.concatenate([np.full(len(corners), corners.shape[1]) for _, corners in cells])
    types = np.concatenate([np.full(len(corners), code, dtype=np.uint8) for code, corners in cells])
    connectivity = np.concatenate([corners.ravel() for _, corners in cells])
    integer = np.int32 if max(len(connectivity), len(mesh.points)) < 2**31 else np.int64
    vector = samples.u.ndim > 1
    gradient = samples.gradient.reshape(len(mesh.points), -1) if vector else _in_space(samples.gradient)
    data = [_array("u", _in_space(samples.u) if vector else samples.u), _array("gradient", gradient)]
    if samples.error is not None:
        data.append(_array("error", _in_space(samples.error) if vector else samples.error))
    data += [_array(name, values) for name, values in samples.derived.items()]
    roles = 'Vectors="u"' if vector else 'Scalars="u" Vectors="gradient"'
    order_of_bytes = "LittleEndian" if sys.byteorder == "little" else "BigEndian"
    lines = [
        '<?xml version="1.0"?>',
        f'<VTKFile type="UnstructuredGrid" version="1.0" byte_order="{order_of_bytes}" '
        'header_type="UInt64" compressor="vtkZLibDataCompressor">',
        "<UnstructuredGrid>",
        f'<Piece NumberOfPoints="{len(mesh.points)}" NumberOfCells="{len(types)}">',
        f"<PointData {roles}>",
        *data,
        "</PointData>",
        "<Points>",
        _array("Points", _in_space(mesh.points)),
        "</Points>",
        "<Cells>",
        _array("connectivity", connectivity.astype(integer)),
        _array("offsets", np.cumsum(sizes).astype(integer)),
        _array("types", types),
        "</Cells>",
        "</Piece>",
        "</UnstructuredGrid>",
        "</VTKFile>",
        "",
    ]
    return "\n".join(lines).encode("ascii")


def _in_space(vectors: Array) -> Array:
    """Vectors (n, d) with zeros for the missing coordinates (n, 3)."""
    return np.pad(vectors, ((0, 0), (0, 3 - vectors.shape[1])))


def _array(name: str, values: NDArray[Any]) -> str:
    components = f' NumberOfComponents="{values.shape[1]}"' if values.ndim > 1 else ""
    kind = VTK_TYPES[values.dtype.str[1:]]
    return (
        f'<DataArray type="{kind}" Name="{name}"{components} format="binary">'
        f"{_encoded(np.ascontiguousarray(values).tobytes())}</DataArray>"
    )


def _encoded(raw: bytes) -> str:
    blocks = [zlib.compress(raw[start : start + BLOCK], 1) for start in range(0, len(raw), BLOCK)]
    header = np.array([len(blocks), BLOCK, len(raw) % BLOCK, *map(len, blocks)], dtype=np.uint64)
    return (base64.b64encode(header.tobytes()) + base64.b64encode(b"".join(blocks))).decode("ascii")
