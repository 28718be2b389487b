"""Surfaces in space drawn without a display or OpenGL: triangles scan-converted into a depth buffer.

Every triangle that faces the eye is cut into the pixels of a supersampled image; the fragment nearest to
the eye wins its pixel.  Colours and normals are interpolated over the triangle, so that a few thousand
triangles look smooth.  The projection is parallel.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rfm.calculus.types import Array

Image = NDArray[np.float64]
Ints = NDArray[np.int64]

OVERSAMPLING = 2
"""Pixels of the depth buffer per pixel of the image, in each direction."""

AMBIENT, DIFFUSE, GLOSS = 0.70, 0.32, 0.08

CHUNK = 20_000
"""Triangles drawn at a time."""


@dataclass(frozen=True)
class Camera:
    """A parallel projection.

    Attributes
    ----------
    right, up, toward
        Orthonormal axes of the view (3,): to the right, upward, toward the eye.
    centre
        The point (3,) in the middle of the picture.
    reach
        Half of the width and height of what is seen.
    """

    right: Array
    up: Array
    toward: Array
    centre: Array
    reach: tuple[float, float]

    @classmethod
    def around(cls, points: Array, azimuth: float, elevation: float, margin: float = 0.03) -> Camera:
        """Look at `points` (n, 3) from an azimuth and an elevation given in degrees."""
        a, e = np.radians([azimuth, elevation])
        toward = np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
        right = np.array([-np.sin(a), np.cos(a), 0.0])
        up = np.cross(toward, right)
        plane = points @ np.stack([right, up], axis=1)
        low, high = plane.min(axis=0), plane.max(axis=0)
        middle, half = 0.5 * (low + high), 0.5 * (high - low) * (1 + 2 * margin)
        centre = middle[0] * right + middle[1] * up
        return cls(right, up, toward, centre, (float(half[0]), float(half[1])))

    def project(self, points: Array) -> Array:
        """Coordinates (n, 3) to the right, upward and toward the eye, relative to the centre."""
        return np.asarray((points - self.centre) @ np.stack([self.right, self.up, self.toward], axis=1))


@dataclass(frozen=True)
class View:
    """What is seen of a set of triangles: for every lit pixel the triangle and the place in it.

    Attributes
    ----------
    shape
        Height and width of the depth buffer.
    pixels
        Flat indices of the lit pixels (n,).
    owner, shares
        Triangle of each of them (n,) and its barycentric coordinates there (n, 3).
    light
        Brightness and gloss (n, 2) from the angle between the normal and the light.
    """

    shape: tuple[int, int]
    pixels: Ints
    owner: Ints
    shares: Array
    light: Array

    def image(self, values: Array, colours: Image, limits: tuple[float, float]) -> Image:
        """Image (height, width, 4) with transparent background.

        Parameters
        ----------
        values
            At the corners of the triangles (m, 3).
        colours
            Table (k, 3) of the colour map.
        limits
            Values of the first and of the last colour.
        """
        value = np.nan_to_num((self.shares * values[self.owner]).sum(axis=1))
        place = np.clip((value - limits[0]) / (limits[1] - limits[0]), 0, 1) * (len(colours) - 1)
        low = np.minimum(place.astype(int), len(colours) - 2)
        share = (place - low)[:, None]
        base = (1 - share) * colours[low] + share * colours[low + 1]
        image = np.zeros((self.shape[0] * self.shape[1], 4))
        image[self.pixels, :3] = np.clip(base * self.light[:, :1] + self.light[:, 1:], 0, 1)
        image[self.pixels, 3] = 1.0
        return _reduced(image.reshape(*self.shape, 4)[::-1])


def look(corners: Array, normals: Array, camera: Camera, pixels: int) -> View:
    """What `camera` sees of triangles, in a picture with `pixels` along its longer side.

    Parameters
    ----------
    corners
        Shape (m, 3, 3): triangle, corner, coordinate; counter-clockwise seen from outside.
    normals
        Unit normals at the corners, same shape; they may point to either side.
    """
    half = np.array(camera.reach)
    scale = OVERSAMPLING * pixels / (2 * float(half.max()))
    width, height = (OVERSAMPLING * max(2, round(side * scale / OVERSAMPLING)) for side in 2 * half)
    flat = np.stack([camera.project(corners[:, k]) for k in range(3)], axis=1)
    flat[..., :2] = (flat[..., :2] + half) * scale
    edges = flat[:, 1:, :2] - flat[:, :1, :2]
    twice = edges[:, 0, 0] * edges[:, 1, 1] - edges[:, 0, 1] * edges[:, 1, 0]
    facing = np.flatnonzero(twice > 1e-9)
    depth = np.full(width * height, -np.inf)
    owner = np.full(width * height, -1, dtype=np.int64)
    shares = np.zeros((width * height, 3))
    for start in range(0, len(facing), CHUNK):
        _draw(flat, facing[start : start + CHUNK], width, height, depth, owner, shares)
    seen = np.flatnonzero(owner >= 0)
    light = _light(normals, camera, owner[seen], shares[seen])
    return View((height, width), seen, owner[seen], shares[seen], light)


def _draw(
    flat: Array, chosen: Ints, width: int, height: int, depth: Array, owner: Ints, shares: Array
) -> None:
    """Enter the fragments of the `chosen` triangles into the depth buffer (rows from below)."""
    corners = flat[chosen]
    low = np.ceil(corners[..., 1].min(axis=1) - 0.5).astype(np.int64).clip(0, height)
    high = np.floor(corners[..., 1].max(axis=1) - 0.5).astype(np.int64).clip(-1, height - 1)
    which, row = _ranges(low, high)
    first, last = _span(corners[which, :, :2], _middles(row))
    low = np.ceil(first - 0.5).astype(np.int64).clip(0, width)
    high = np.floor(last - 0.5).astype(np.int64).clip(-1, width - 1)
    span, column = _ranges(low, high)
    which, row = which[span], row[span]
    weights = _barycentric(corners[which, :, :2], _middles(column), _middles(row))
    near = (weights * corners[which, :, 2]).sum(axis=1)
    pixel = row * width + column
    np.maximum.at(depth, pixel, near)
    won = near >= depth[pixel]
    owner[pixel[won]] = chosen[which[won]]
    shares[pixel[won]] = weights[won]


def _middles(pixels: Ints) -> Array:
    return np.asarray(pixels, dtype=np.float64) + 0.5


def _ranges(low: Ints, high: Ints) -> tuple[Ints, Ints]:
    """All integers from low to high of every row: (number of the row, integer)."""
    count = np.maximum(high - low + 1, 0)
    which = np.repeat(np.arange(len(count)), count)
    begin = np.cumsum(count) - count
    return which, np.arange(len(which)) - begin[which] + low[which]


def _span(corners: Array, level: Array) -> tuple[Array, Array]:
    """Where triangles (n, 3, 2) meet the horizontal lines at `level` (n,): from, to."""
    first, last = np.full(len(level), np.inf), np.full(len(level), -np.inf)
    for a, b in ((0, 1), (1, 2), (2, 0)):
        start, end = corners[:, a], corners[:, b]
        rise = end[:, 1] - start[:, 1]
        t = (level - start[:, 1]) / np.where(rise == 0, 1, rise)
        crosses = (rise != 0) & (t >= 0) & (t <= 1)
        x = start[:, 0] + t * (end[:, 0] - start[:, 0])
        first = np.where(crosses, np.minimum(first, x), first)
        last = np.where(crosses, np.maximum(last, x), last)
    empty = first > last
    return np.where(empty, 1.0, first), np.where(empty, -1.0, last)


def _barycentric(corners: Array, x: Array, y: Array) -> Array:
    """Weights (n, 3) of the corners (n, 3, 2) at the points (x, y)."""
    ax, ay = corners[:, 0, 0], corners[:, 0, 1]
    bx, by = corners[:, 1, 0] - ax, corners[:, 1, 1] - ay
    cx, cy = corners[:, 2, 0] - ax, corners[:, 2, 1] - ay
    area = bx * cy - by * cx
    second = ((x - ax) * cy - (y - ay) * cx) / area
    third = (bx * (y - ay) - by * (x - ax)) / area
    return np.stack([1 - second - third, second, third], axis=1)


def _light(normals: Array, camera: Camera, owner: Ints, shares: Array) -> Array:
    """Brightness and gloss (n, 2) of the fragments."""
    normal = np.einsum("nk,nkc->nc", shares, normals[owner])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    normal *= np.where(normal @ camera.toward < 0, -1.0, 1.0)[:, None]  # what is seen faces the eye
    direction = camera.toward + 0.45 * camera.up - 0.35 * camera.right
    facing = np.clip(normal @ (direction / np.linalg.norm(direction)), 0, 1)
    return np.stack([AMBIENT + DIFFUSE * facing, GLOSS * facing**24], axis=1)


def _reduced(image: Image) -> Image:
    """Average of the pixels of the depth buffer, colours weighted by opacity."""
    height, width = image.shape[0] // OVERSAMPLING, image.shape[1] // OVERSAMPLING
    image = image.copy()
    image[..., :3] *= image[..., 3:]
    blocks = image.reshape(height, OVERSAMPLING, width, OVERSAMPLING, 4).mean(axis=(1, 3))
    opacity = np.maximum(blocks[..., 3:], 1e-12)
    blocks[..., :3] = np.clip(blocks[..., :3] / opacity, 0, 1)
    return np.asarray(blocks)
