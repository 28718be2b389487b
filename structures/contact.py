"""Points on parts of the boundary, and points where two parts meet, found from starts spread over the domain."""

from __future__ import annotations

import numpy as np

from rfm.calculus.jets import partials
from rfm.calculus.types import Array, Field
from rfm.geometry.box import Box
from rfm.geometry.gauss_newton import CONVERGED, nearest_zeros
from rfm.geometry.part import Part
from rfm.geometry.shape import Shape
from rfm.geometry.spread import spread
from rfm.geometry.surface import Surface

SEEDS = 256


def boundary_points(domain: Shape, part: Part, seeds: Array | None = None) -> Array:
    """Return points ``(n, d)`` spread over a part of the boundary.

    Parameters
    ----------
    domain
        The shape.
    part
        A part of its boundary.
    seeds
        Starting points ``(n, d)``; by default spread over the domain's box.
    """
    starts = spread_points(domain) if seeds is None else np.asarray(seeds, float)
    found = [np.empty((0, domain.dimension))]
    for piece in part.pieces:
        for surface in _sorted(piece):
            points = nearest_zeros([surface.function], starts, size_of(domain))
            # surfaces cross the domain too: only where the sign vanishes are they boundary
            on = np.abs(_values(domain.sign, points)) < CONVERGED * size_of(domain)
            found.append(points[on & np.asarray(piece.selects(points), bool)])
    return np.concatenate(found)


def meeting_points(domain: Shape, a: Part, b: Part, seeds: Array | None = None) -> Array:
    """Return points ``(n, d)`` of the closed domain that belong to both parts, each once.

    In the plane these are the corners themselves; in space samples of the common edges.

    Parameters
    ----------
    domain
        The shape.
    a, b
        Two parts of its boundary.
    seeds
        Starting points ``(n, d)``; by default spread over the domain's box.
    """
    starts = spread_points(domain) if seeds is None else np.asarray(seeds, float)
    found = [np.empty((0, domain.dimension))]
    for piece_a in a.pieces:
        for piece_b in b.pieces:
            for pair in _function_pairs(piece_a, piece_b):
                points = _on_domain(domain, nearest_zeros(pair, starts, size_of(domain)))
                found.append(_where(_where(points, piece_a, domain), piece_b, domain))
    return _distinct(np.concatenate(found), 1e-7 * size_of(domain))


def spread_points(domain: Shape, count: int = SEEDS) -> Array:
    """Return ``count`` points spread evenly over the domain's box."""
    box = finite_box(domain.box)
    lower, upper = np.array(box.lower), np.array(box.upper)
    return np.asarray(lower + spread(count, domain.dimension) * (upper - lower))


def finite_box(box: Box) -> Box:
    """Return the box with infinite sides replaced by -1 and 1 (or one away from the finite end)."""
    lower, upper = np.array(box.lower, float), np.array(box.upper, float)
    lower = np.where(np.isfinite(lower), lower, np.where(np.isfinite(upper), upper - 1.0, -1.0))
    upper = np.where(np.isfinite(upper), upper, np.maximum(lower + 1.0, 1.0))
    return Box(tuple(lower.tolist()), tuple(upper.tolist()))


def size_of(domain: Shape) -> float:
    """Return the longest side of the domain's box."""
    box = finite_box(domain.box)
    return float(np.subtract(box.upper, box.lower).max())


def _function_pairs(a: Part, b: Part) -> list[tuple[Field, Field]]:
    """Return pairs of functions whose common zeros may belong to both.

    Two conditions on pieces of one surface meet where one of them ends.
    """
    pairs: list[tuple[Field, Field]] = []
    for surface_a in _sorted(a):
        for surface_b in _sorted(b):
            if surface_a is not surface_b:
                pairs.append((surface_a.function, surface_b.function))
            else:
                ends = (part.where for part in (a, b) if part.where is not None)
                pairs.extend((surface_a.function, end) for end in ends)
    return pairs


def _sorted(part: Part) -> list[Surface]:
    return sorted(part.surfaces, key=lambda surface: surface.label)


def _on_domain(domain: Shape, points: Array) -> Array:
    return points[_values(domain.sign, points) > -CONVERGED * size_of(domain)]


def _where(points: Array, part: Part, domain: Shape) -> Array:
    if part.where is None:
        return points
    return points[_values(part.where, points) > -CONVERGED * size_of(domain)]


def _values(field: Field, points: Array) -> Array:
    with np.errstate(all="ignore"):
        values: Array = partials(field, tuple(points.T), 0)[0]
    return values


def _distinct(points: Array, tolerance: float) -> Array:
    """Return one representative of every cluster narrower than ``tolerance``, in lexicographic order."""
    rounded = np.round(points / tolerance)
    _, first = np.unique(rounded, axis=0, return_index=True)
    kept: list[Array] = []
    for point in points[first]:  # clusters cut by the rounding leave a few doubles
        if not kept or np.abs(np.array(kept) - point).max(axis=1).min() > tolerance:
            kept.append(point)
    return np.array(kept).reshape(-1, points.shape[1])
