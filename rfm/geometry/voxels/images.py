r"""M-images: the characteristics of a functional voxel model as pictures.

A characteristic n_i in [-1, 1] becomes the level

.. math:: M_i = \operatorname{round}\Bigl(\frac{1 + n_i}{2} (P - 1)\Bigr), \qquad P = 2^{24} \text{ or } 2^8,

the three bytes of a pixel of an RGB image, or a grey pixel.  There is one PNG for each characteristic, ``NAME-1.png``
to ``NAME-(n+2).png``; x runs to the right, y upward, and the slices of a model in space are stacked, the lowest z
on top.  The box, the scale and the counts are stored as text in the image, so that the set of files is the model.

A level is off by at most delta = 1 / (P - 1), so that the value u = -scale (n . xi + n_{n+2}) / n_{n+1} read back at a
node is off by at most about :func:`accuracy`: 6e-8 or 4e-3 times (sum |xi_i| + 1 + |u| / scale) scale / |n_{n+1}|.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rfm.calculus.types import Array
from rfm.errors import GeometryError
from rfm.geometry.box import Box
from rfm.geometry.voxels.model import VoxelModel, scaled

LEVELS = {"rgb": 2**24, "grey": 2**8}
"""Number of levels P of the two kinds of image."""
KEY = "functional voxels"


def write_images(model: VoxelModel, folder: str | Path, name: str, kind: str = "rgb") -> list[Path]:
    """Write the M-images of a model.

    Parameters
    ----------
    model
        In the plane or in space.
    folder
        Where; it must exist.
    name
        Beginning of the names of the files.
    kind
        ``rgb`` (24 bits) or ``grey`` (8 bits).

    Returns
    -------
    list of Path
        The files, one for each characteristic.

    Raises
    ------
    GeometryError
        There is no such kind, or the model has more than three variables.
    """
    from PIL.PngImagePlugin import PngInfo

    levels = _levels(kind)
    if model.dimension not in (2, 3):
        raise GeometryError(f"images are for two or three variables, this model has {model.dimension}")
    note = PngInfo()
    note.add_text(
        KEY,
        json.dumps(
            {
                "lower": model.box.lower,
                "upper": model.box.upper,
                "scale": model.scale,
                "counts": model.counts,
                "kind": kind,
            }
        ),
    )
    paths = []
    for i, characteristic in enumerate(model.characteristics):
        path = Path(folder) / f"{name}-{i + 1}.png"
        quantised = np.rint(0.5 * (1.0 + characteristic) * (levels - 1)).astype(np.uint32)
        _picture(_rows(quantised), kind).save(path, pnginfo=note)
        paths.append(path)
    return paths


def read_images(folder: str | Path, name: str) -> VoxelModel:
    """Read a model from its M-images.

    Raises
    ------
    GeometryError
        A file is missing or is no M-image, or the images belong to different models.
    """
    notes, found = [], []
    first = _opened(Path(folder) / f"{name}-1.png")
    count = len(first[0]["counts"]) + 2
    for i in range(count):
        note, pixels = _opened(Path(folder) / f"{name}-{i + 1}.png")
        notes.append(note)
        found.append(2.0 * _lattice(pixels, note) / (_levels(note["kind"]) - 1) - 1.0)
    if any(note != notes[0] for note in notes):
        raise GeometryError(f"the images {name}-1.png to {name}-{count}.png belong to different models")
    note = notes[0]
    return VoxelModel(Box(tuple(note["lower"]), tuple(note["upper"])), float(note["scale"]), np.stack(found))


def accuracy(model: VoxelModel, kind: str = "rgb") -> Array:
    """Bound of the error of the values at the nodes after writing and reading, to first order in the level."""
    delta = 1.0 / (_levels(kind) - 1)
    xi = scaled(model.box, model.nodes)
    reach = sum(np.abs(x) for x in xi) + 1.0 + np.abs(model.values) / model.scale
    return np.asarray(delta * model.scale * reach / np.abs(model.characteristics[-2]))


def _levels(kind: str) -> int:
    if kind not in LEVELS:
        raise GeometryError(f"unknown kind of image {kind!r}; choose one of {', '.join(LEVELS)}")
    return LEVELS[kind]


def _rows(quantised: NDArray[Any]) -> NDArray[Any]:
    """Rows of a picture: y upward, the slices of space below each other."""
    if quantised.ndim == 2:
        return quantised.T[::-1]
    return np.concatenate([quantised[:, :, k].T[::-1] for k in range(quantised.shape[2])])


def _lattice(pixels: Array, note: dict[str, Any]) -> Array:
    """Undo :func:`_rows`."""
    counts = note["counts"]
    if len(counts) == 2:
        return pixels[::-1].T
    slices = pixels.reshape(counts[2], counts[1], counts[0])
    return np.stack([one[::-1].T for one in slices], axis=2)


def _picture(levels: NDArray[Any], kind: str) -> Any:
    from PIL import Image

    if kind == "grey":
        return Image.fromarray(levels.astype(np.uint8))
    parts = [(levels >> shift) & 255 for shift in (16, 8, 0)]
    return Image.fromarray(np.stack(parts, axis=2).astype(np.uint8))


def _opened(path: Path) -> tuple[dict[str, Any], Array]:
    """Note and levels of an image."""
    from PIL import Image

    try:
        with Image.open(path) as picture:
            text = picture.info.get(KEY)
            pixels = np.asarray(picture).astype(np.float64)
    except OSError as error:
        raise GeometryError(f"{path} cannot be read as an image: {error}") from error
    if text is None:
        raise GeometryError(f"{path} is no M-image: it does not name its box and scale")
    if pixels.ndim == 3:
        pixels = pixels @ np.array([65536.0, 256.0, 1.0])
    return json.loads(text), pixels
