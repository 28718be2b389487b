r"""Heights of surfaces over a base, and where two of them meet.

Notation: in a two-dimensional slice ``(x, y)`` a function whose derivative along ``x`` has one sign has a *height*
:math:`x = h(y)` with :math:`f(h(y), y) = 0` wherever that lies in ``[0, 1]``; ``c (n, K+1, K+1)`` are Bernstein
coefficients, ``x`` first.  Two heights meet where :math:`g(y) = f_2(h_1(y), y)` vanishes.  ``g`` is smooth as long as
``h_1`` exists, that is between the roots of ``f_1`` on the faces ``x = 0`` and ``x = 1``; it is interpolated there, its
roots are found and polished on the pair ``f_1 = f_2 = 0``.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from solvers.quadrature import bernstein
from solvers.quadrature.pieces import broken
from solvers.quadrature.roots import monotone_root, real_roots

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rfm.calculus.types import Array
    from solvers.grid import Integers
    from solvers.quadrature.pieces import Breaks

DEGREE = 10
"""Degree to which a height function composed with another surface is interpolated."""

POLISHING = 4

ENOUGH = 0.1
"""Least over greatest derivative with which a function is taken for the height without looking at the other one."""


def height(lines: Array, noise: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Return where monotone functions vanish on lines, and whether they do.

    Parameters
    ----------
    lines
        Coefficients along the line, shape ``(..., K + 1)``.
    noise
        Rounding level of the coefficients, broadcastable to ``(...)``; a root within it of an end lies on the end.
    """
    first, last = lines[..., 0], lines[..., -1]
    exists = (np.minimum(first, last) <= noise) & (np.maximum(first, last) >= -noise)
    if lines.shape[-1] <= 3:
        root = monotone_root(lines)
    else:
        root = np.zeros(exists.shape)
        root[exists] = monotone_root(lines[exists])
    root = np.where(np.abs(last) <= noise, 1.0, root)
    return np.where(np.abs(first) <= noise, 0.0, root), exists


def restrict(c: Array, t: Array) -> Array:
    """Fix the last variable: ``c (n, ..., K+1)`` at ``t (n, q)`` gives ``(n, q, ...)``."""
    n, q = t.shape
    basis = bernstein.basis(c.shape[-1] - 1, t)
    flat = basis @ c.reshape(n, math.prod(c.shape[1:-1]), c.shape[-1]).transpose(0, 2, 1)
    return np.asarray(flat.reshape(n, q, *c.shape[1:-1]))


def face_roots(c: Array, noise: Array) -> Breaks:
    """Return the roots of slices ``c (n, m, K+1, K+1)`` on the faces ``x = 0`` and ``x = 1``."""
    n, m, _, k = c.shape
    faces = c[:, :, [0, -1], :].reshape(n * m * 2, k)
    index, root = real_roots(faces, np.repeat(noise.reshape(-1), 2))
    return index // (2 * m), root


def meetings(c1: Array, c2: Array, noise1: Array, noise2: Array) -> tuple[Integers, Array, Array]:
    """Return where two functions vanish together in each slice.

    Parameters
    ----------
    c1, c2
        Coefficients of both functions, shape ``(n, K+1, K+1)``; one of the two at least is monotone along ``x``.
    noise1, noise2
        Rounding levels, shape ``(n,)``.

    Returns
    -------
    tuple
        Flat lists: slice number, ``y``, ``x``.
    """
    low, high = bernstein.bounds(np.stack([c1, c2]), 2)
    both = ((low <= np.stack([noise1, noise2])) & (high >= -np.stack([noise1, noise2]))).all(axis=0)
    candidates = np.flatnonzero(both)
    if not candidates.size:
        return candidates, np.zeros(0), np.zeros(0)
    c1, c2, noise1, noise2 = c1[candidates], c2[candidates], noise1[candidates], noise2[candidates]
    steadiness = _steadiness(c1, noise1)
    swap = (steadiness < ENOUGH) & (_steadiness(c2, noise2) > steadiness)
    c1, c2 = np.where(swap[:, None, None], c2, c1), np.where(swap[:, None, None], c1, c2)
    noise1, noise2 = np.where(swap, noise2, noise1), np.where(swap, noise1, noise2)
    pieces = broken(len(candidates), [face_roots(c1[:, None], noise1[:, None])])
    middle = restrict(c1[pieces.owner], pieces.nodes(np.array([0.5])))[:, 0]
    pieces = pieces.take(np.flatnonzero(height(middle, noise1[pieces.owner])[1]))
    if not len(pieces.owner):
        return candidates[:0], np.zeros(0), np.zeros(0)
    owner = pieces.owner
    y = pieces.nodes(bernstein.lobatto(DEGREE))
    x, _ = height(restrict(c1[owner], y), noise1[owner, None])
    values = bernstein.evaluate(restrict(c2[owner], y), x)
    piece, at = real_roots(bernstein.interpolate(values, 1), noise2[owner])
    # A meeting where the height leaves the box may be lost to rounding: take such ends for meetings.
    end, side = np.nonzero(np.abs(values[:, [0, -1]]) <= 1e3 * noise2[owner, None])
    piece, at = np.concatenate([piece, end]), np.concatenate([at, side.astype(np.float64)])
    where = owner[piece]
    guess_y = pieces.start[piece] + pieces.length[piece] * at
    guess_x, _ = height(restrict(c1[where], guess_y[:, None])[:, 0], noise1[where])
    found_y, found_x = _polish(c1[where], c2[where], guess_y, guess_x)
    return candidates[where], found_y, found_x


def _steadiness(c: Array, noise: Array) -> Array:
    """Least over greatest derivative along ``x``, 0 where it changes sign or is noise."""
    low, high = bernstein.bounds(bernstein.derivative(c, 1), 2)
    least = np.where(low > 0, low, np.where(high < 0, -high, 0.0))
    return np.where(
        least > 4 * c.shape[-1] * noise,
        least / np.maximum(np.maximum(np.abs(low), np.abs(high)), 1e-300),
        0.0,
    )


def _polish(c1: Array, c2: Array, y0: Array, x0: Array) -> tuple[Array, Array]:
    """Newton's method for both functions at once; keeps the guess where it runs away."""
    x, y = x0, y0
    c = np.stack([c1, c2], axis=1)
    c_x, c_y = bernstein.derivative(c, 2), bernstein.derivative(c, 3)
    with np.errstate(all="ignore"):
        for _ in range(POLISHING):
            f, f_x, f_y = (_at(part, x, y) for part in (c, c_x, c_y))
            determinant = f_x[:, 0] * f_y[:, 1] - f_x[:, 1] * f_y[:, 0]
            x = x - (f[:, 0] * f_y[:, 1] - f[:, 1] * f_y[:, 0]) / determinant
            y = y - (f_x[:, 0] * f[:, 1] - f_x[:, 1] * f[:, 0]) / determinant
        good = (np.abs(x - x0) + np.abs(y - y0) < 0.01) & (np.abs(y - 0.5) <= 0.5)
    return np.where(good, y, y0), np.where(good, np.clip(x, 0.0, 1.0), x0)


def _at(c: Array, x: Array, y: Array) -> Array:
    """Values of ``c (n, 2, *, *)`` at points ``(x, y)`` of shape ``(n,)``, shape ``(n, 2)``."""
    bx = bernstein.basis(c.shape[2] - 1, x)
    by = bernstein.basis(c.shape[3] - 1, y)
    return np.asarray(np.einsum("nsij,ni,nj->ns", c, bx, by))


def triple_points(
    c: Array, noise: Array, triples: list[tuple[int, int, int]], breaks: list[Breaks]
) -> list[Breaks]:
    """Return the ``z`` at which three functions of ``c (n, m, K+1, K+1, K+1)`` vanish together.

    Along each piece of the ``z`` axis left by ``breaks`` the meeting points of the first two functions are followed;
    the third one on them is interpolated in ``z``.
    """
    pieces = broken(len(c), breaks)
    nodes = bernstein.lobatto(DEGREE)
    # The ends of a piece are where the structure changes: stay a little inside.
    z = pieces.nodes(1e-9 + (1.0 - 2e-9) * nodes)
    slices = restrict(c[pieces.owner], z)
    p, q = slices.shape[:2]
    flat = slices.reshape(p * q, *slices.shape[2:])
    level = np.repeat(noise[pieces.owner], q, axis=0)
    found = []
    for i, j, k in triples:
        where, y, x = meetings(flat[:, i], flat[:, j], level[:, i], level[:, j])
        order = np.lexsort((y, where))
        where, y, x = where[order], y[order], x[order]
        once = np.append(True, (np.diff(where) > 0) | (np.diff(y) > 1e-7))[: len(where)]
        where, y, x = where[once], y[once], x[once]
        counts = np.bincount(where, minlength=p * q).reshape(p, q)
        first = (np.cumsum(counts.ravel()) - counts.ravel()).reshape(p, q)
        third = np.einsum(
            "nij,ni,nj->n",
            flat[where, k],
            bernstein.basis(c.shape[2] - 1, x),
            bernstein.basis(c.shape[3] - 1, y),
        )
        for rank in range(int(counts.min(axis=1).max(initial=0))):
            followed = np.flatnonzero((counts == counts[:, :1]).all(axis=1) & (counts[:, 0] > rank))
            values = third[first[followed] + rank]
            piece, at = real_roots(bernstein.interpolate(values, 1), noise[pieces.owner[followed], k])
            chosen = followed[piece]
            found.append((pieces.owner[chosen], pieces.start[chosen] + pieces.length[chosen] * at))
    return found


def edge_breaks(c: Array, noise: Array, pairs: list[tuple[int, int]]) -> list[Breaks]:
    """Return the ``z`` at which the slices of ``c (n, m, K+1, K+1, K+1)`` (``x, y, z``) change their structure.

    These are the roots on the four edges along ``z``, and the points where two surfaces meet on a face ``x = const``
    (heights along ``y``) or ``y = const`` (heights along ``x``).
    """
    n, m, k = c.shape[:3]
    edges = c[:, :, [0, 0, -1, -1], [0, -1, 0, -1], :].reshape(n * m * 4, k)
    index, root = real_roots(edges, np.repeat(noise.reshape(-1), 4))
    found: list[Breaks] = [(index // (4 * m), root)]
    if pairs:
        # the four faces at once: a call costs more than a hundred faces
        faces = np.concatenate([c[:, :, 0], c[:, :, -1], c[:, :, :, 0], c[:, :, :, -1]])
        level = np.tile(noise, (4, 1))
        for i, j in pairs:
            where, z, _ = meetings(faces[:, i], faces[:, j], level[:, i], level[:, j])
            found.append((where % n, z))
    return found
