"""``solution.h5`` and ``summary.json``: enough of a run to load and evaluate it anywhere.

Layout of the HDF5 file (format 1)::

    /                attributes: format, name, title, degree, basis, started, finished
    /coefficients    coefficients of the first psi: of splines on the full index grid (cells + degree in every
                     direction), of other bases as they define them (solvers/bases)
    /splines/1, ...  those of the other splines, where there are several; attribute: degree
    /grid            attributes: lower, spacing, cells
    /versions        attributes: package -> version
    /host            attributes: name, system, machine, processors
    /case.json       the resolved case, text: what is loaded
    /case.yaml       the same for people
    /summary.json    the summary, text

The file is composed in memory and written by plain output, so that a full disk is an ordinary error.
"""

from __future__ import annotations

import io
import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from rfm.app.record import FurtherSpline, Provenance, RunRecord
from rfm.calculus.types import Array
from rfm.errors import RfmError

FORMAT = 1


class StorageError(RfmError):
    """A file is not a solution that this version can load."""


@dataclass(frozen=True)
class StoredSolution:
    """What ``solution.h5`` holds.

    Attributes
    ----------
    lower, spacing, cells
        The grid: its lower corner, the sides of a cell, the number of cells (tuples of length d).
    coefficients
        Coefficients of the first spline on the full index grid.
    more
        The other splines.
    case, case_text
        The resolved case as data and as YAML text.
    """

    name: str
    title: str
    degree: int
    basis: str
    lower: tuple[float, ...]
    spacing: tuple[float, ...]
    cells: tuple[int, ...]
    coefficients: Array
    case: Mapping[str, Any]
    case_text: str
    summary: Mapping[str, Any]
    provenance: Provenance
    more: tuple[FurtherSpline, ...] = ()


def solution_bytes(record: RunRecord) -> bytes:
    """Content of ``solution.h5``."""
    import h5py

    buffer = io.BytesIO()
    with h5py.File(buffer, "w") as file:
        file.attrs.update(
            {
                "format": FORMAT,
                "name": record.name,
                "title": record.title,
                "degree": record.degree,
                "basis": record.basis,
                "started": record.provenance.started,
                "finished": record.provenance.finished,
            }
        )
        file.create_dataset("coefficients", data=np.asarray(record.coefficients, dtype=np.float64))
        for number, spline in enumerate(record.more, start=1):
            name = f"splines/{number}"
            file.create_dataset(name, data=np.asarray(spline.coefficients, dtype=np.float64))
            file[name].attrs["degree"] = spline.degree
        grid = file.create_group("grid")
        grid.attrs["lower"] = np.asarray(record.grid.lower, dtype=np.float64)
        grid.attrs["spacing"] = np.asarray(record.grid.spacing, dtype=np.float64)
        grid.attrs["cells"] = np.asarray(record.grid.cells, dtype=np.int64)
        file.create_group("versions").attrs.update(record.provenance.versions)
        file.create_group("host").attrs.update(record.provenance.host)
        file["case.json"] = json.dumps(plain(record.case), ensure_ascii=False)
        file["case.yaml"] = case_text(record.case)
        file["summary.json"] = summary_text(record.summary)
    return buffer.getvalue()


def load(path: str | Path) -> StoredSolution:
    """Load ``solution.h5``; `path` is the file or the run directory that holds it.

    Raises
    ------
    StorageError
        There is no such file, or it is no solution, truncated, or of a later format.
    """
    import h5py

    file_path = Path(path)
    if file_path.is_dir():
        file_path = file_path / "solution.h5"
    if not file_path.is_file():
        raise StorageError(f"{file_path}: no such file: give a run directory or its solution.h5")
    try:
        with h5py.File(file_path, "r") as file:
            return _read(file, file_path)
    except KeyError as error:
        raise StorageError(f"{file_path} is not a solution of rfm: {error.args[0]}") from error
    except OSError as error:
        raise StorageError(f"{file_path} cannot be read as HDF5 (truncated?): {error}") from error


def _read(file: Any, path: Path) -> StoredSolution:
    attributes = file.attrs
    found = int(attributes["format"])
    if found > FORMAT:
        raise StorageError(
            f"{path} has format {found}, this version reads up to {FORMAT}: install a newer rfm"
        )
    grid = file["grid"].attrs
    return StoredSolution(
        name=str(attributes["name"]),
        title=str(attributes["title"]),
        degree=int(attributes["degree"]),
        basis=str(attributes["basis"]),
        lower=tuple(float(value) for value in grid["lower"]),
        spacing=tuple(float(value) for value in grid["spacing"]),
        cells=tuple(int(value) for value in grid["cells"]),
        coefficients=np.asarray(file["coefficients"][()], dtype=np.float64),
        case=json.loads(file["case.json"].asstr()[()]),
        case_text=file["case.yaml"].asstr()[()],
        summary=json.loads(file["summary.json"].asstr()[()]),
        provenance=Provenance(
            versions={key: str(value) for key, value in file["versions"].attrs.items()},
            host={key: str(value) for key, value in file["host"].attrs.items()},
            started=str(attributes["started"]),
            finished=str(attributes["finished"]),
        ),
        more=tuple(
            FurtherSpline(
                int(file[f"splines/{number}"].attrs["degree"]),
                np.asarray(file[f"splines/{number}"][()], dtype=np.float64),
            )
            for number in range(1, 1 + len(file.get("splines", ())))
        ),
    )


def case_text(case: Mapping[str, Any]) -> str:
    """The resolved case as YAML, keys in their order."""
    from ruamel.yaml import YAML

    yaml = YAML()
    yaml.width = 100
    yaml.indent(mapping=2, sequence=4, offset=2)
    stream = io.StringIO()
    yaml.dump(_short_lists_inline(plain(case)), stream)
    return stream.getvalue()


def summary_text(summary: Mapping[str, Any]) -> str:
    """The summary as strict JSON; numbers that are not finite become null."""
    return json.dumps(_finite(plain(summary)), indent=2, allow_nan=False, ensure_ascii=False) + "\n"


def plain(value: Any) -> Any:
    """`value` with arrays, tuples, paths and NumPy numbers turned into plain YAML and JSON values."""
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    if isinstance(value, (np.ndarray, np.generic)):
        return plain(value.tolist())
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    return str(value)


def _finite(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_finite(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _short_lists_inline(value: Any) -> Any:
    """Lists of numbers and words, and mappings of numbers, read better on one line."""
    from ruamel.yaml.comments import CommentedMap, CommentedSeq

    if isinstance(value, dict):
        mapping = CommentedMap((key, _short_lists_inline(item)) for key, item in value.items())
        if value and all(isinstance(item, (int, float)) for item in value.values()):
            mapping.fa.set_flow_style()
        return mapping
    if isinstance(value, list):
        sequence = CommentedSeq(_short_lists_inline(item) for item in value)
        if all(isinstance(item, (int, float)) or _is_word(item) for item in value):
            sequence.fa.set_flow_style()
        return sequence
    return value


def _is_word(item: Any) -> bool:
    """Whether a text needs no care on one line with others."""
    return isinstance(item, str) and item.replace(".", "").replace("_", "").isalnum()
