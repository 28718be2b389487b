r"""Bezier and B-spline curves of degree one to three, in the plane and in space.

Notation: ``P(r) = sum_i a_i r^i``, 0 <= r <= 1, has control points b_0 .. b_k.  Its carrier is exact:

    degree 1                  a segment                                ``segments``
    degree 2                  a parabola in its plane                  ``parabolas``
    degree 3 in a plane       the implicit cubic, cut into arcs        ``cubics``, ``cubic_arcs``
    degree 3 in space         the twisted cubic                        ``twisted_cubics``

so the function of a curve vanishes on it to rounding; no foot point is searched.  A B-spline curve is
cut at its knots: the control points of a span [s, t] are the values of its polar form [1] at (s, .., s, t, .., t).

Reference: [1] L. Ramshaw, Blossoms are polar forms, Computer Aided Geometric Design 6 (1989) 323-358.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rfm.calculus.types import Array
from rfm.errors import GeometryError
from rfm.geometry.boundaries.cubic_arcs import cubic_arcs
from rfm.geometry.boundaries.cubics import Cubics
from rfm.geometry.boundaries.parabolas import parabola
from rfm.geometry.boundaries.pieces import Joined, Pieces, gathered
from rfm.geometry.boundaries.segments import checked_points, segments
from rfm.geometry.boundaries.twisted_cubics import twisted_cubic
from rfm.geometry.checks import shown

SAME = 2e-14
"""Size below which a coefficient, or the distance of a curve from a line or a plane, is rounding, relative to the
control points."""

HIGHEST = 3

POWERS = (
    np.eye(1),
    np.array([[1.0, 0.0], [-1.0, 1.0]]),
    np.array([[1.0, 0.0, 0.0], [-2.0, 2.0, 0.0], [1.0, -2.0, 1.0]]),
    np.array([[1.0, 0.0, 0.0, 0.0], [-3.0, 3.0, 0.0, 0.0], [3.0, -6.0, 3.0, 0.0], [-1.0, 3.0, -3.0, 1.0]]),
)
"""Coefficients a_i of a Bezier curve from its control points, by degree."""


def bezier(control: Sequence[Sequence[float]] | Array, *, p: int = 2) -> Joined:
    """Bezier curve with two, three or four control points.

    Raises
    ------
    GeometryError
        For a higher degree, a curve that is a point, and a cusp.
    """
    points = checked_points(control, "a Bezier curve", 2)
    if len(points) > HIGHEST + 1:
        raise GeometryError(
            f"a Bezier curve has at most {HIGHEST + 1} control points, got {len(points)}; give a curve of higher "
            "degree as a B-spline curve of degree 3 through points of it"
        )
    return Joined(gathered(_pieces(points)), p)


def spline(
    control: Sequence[Sequence[float]] | Array,
    degree: int = 3,
    knots: Sequence[float] | Array | None = None,
    *,
    p: int = 2,
) -> Joined:
    """B-spline curve.

    Parameters
    ----------
    control
        Control points (n, 2) or (n, 3).
    degree
        1, 2 or 3.
    knots
        n + degree + 1 numbers that do not decrease; by default uniform with the curve clamped to the first and
        the last control point.
    p
        Order of the R-equivalence that joins the spans.

    Raises
    ------
    GeometryError
        For a degree or knots that do not suit, and as :func:`bezier` does.
    """
    points = checked_points(control, "a B-spline curve", 2)
    if degree not in range(1, HIGHEST + 1):
        raise GeometryError(f"the degree of a B-spline curve must be 1, 2 or 3, got {shown(degree)}")
    if len(points) <= degree:
        raise GeometryError(
            f"a B-spline curve of degree {degree} needs at least {degree + 1} control points, got {len(points)}"
        )
    vector = _clamped(len(points), degree) if knots is None else _checked_knots(knots, len(points), degree)
    spans = [i for i in range(degree, len(points)) if vector[i] < vector[i + 1]]
    if not spans:
        raise GeometryError(f"the knots {shown(vector)} leave no span for a curve of degree {degree}")
    pieces = [piece for span in spans for piece in _pieces(_span(points, vector, degree, span))]
    return Joined(gathered(pieces), p)


def _clamped(count: int, degree: int) -> Array:
    inner = np.arange(count - degree + 1, dtype=np.float64)
    return np.concatenate([np.zeros(degree), inner, np.full(degree, inner[-1])])


def _checked_knots(knots: Sequence[float] | Array, count: int, degree: int) -> Array:
    vector = np.asarray(knots, dtype=np.float64)
    wanted = count + degree + 1
    if vector.shape != (wanted,):
        raise GeometryError(
            f"a B-spline curve of degree {degree} with {count} control points needs {wanted} knots, "
            f"got {vector.size}"
        )
    wrong = np.flatnonzero(~(np.diff(vector) >= 0.0))
    if len(wrong) or not np.isfinite(vector).all():
        raise GeometryError(f"the knots must be finite and must not decrease, got {shown(vector)}")
    return vector


def _span(points: Array, knots: Array, degree: int, span: int) -> Array:
    """Bezier control points of the curve on [knots[span], knots[span + 1]]."""
    ends = knots[span], knots[span + 1]
    return np.array(
        [_polar(points, knots, span, [ends[0]] * (degree - k) + [ends[1]] * k) for k in range(degree + 1)]
    )


def _polar(points: Array, knots: Array, span: int, arguments: list[float]) -> Array:
    """Polar form of the span's polynomial by de Boor's recursion."""
    degree = len(arguments)
    d = points[span - degree : span + 1]
    for level, argument in enumerate(arguments, start=1):
        left = knots[span - degree + level : span + 1]
        right = knots[span + 1 : span + 1 + degree - level + 1]
        share = ((argument - left) / (right - left))[:, None]
        d = (1.0 - share) * d[:-1] + share * d[1:]
    return np.asarray(d[0])


def _pieces(control: Array) -> list[Pieces]:
    """Pieces of a Bezier curve, by the flat that holds it and the degree it really has."""
    a = POWERS[len(control) - 1] @ control
    extent, rounding = float(np.abs(control - control[0]).max()), SAME * float(np.abs(control).max())
    if extent <= rounding:
        raise GeometryError(f"all control points are the same point {shown(control[0])}")
    lengths = np.linalg.norm(a[1:], axis=1)
    degree = 1 + int(np.flatnonzero(lengths > rounding)[-1])
    a = a[: degree + 1]
    _, values, axes = np.linalg.svd(a[1:], full_matrices=False)
    rank = int((values > rounding).sum())
    if rank == 1:
        return [segments(_extremes(a, axes[0]))]
    if degree == 2:
        return [parabola(np.linalg.solve(POWERS[2], a))]
    if rank == 3:
        return [twisted_cubic(control, a)]
    return [_in_plane(a, axes[:2] if control.shape[1] == 3 else np.eye(2))]


def _extremes(a: Array, axis: Array) -> Array:
    """Ends of the segment that a curve on a line fills: where it starts, ends or turns back."""
    along = np.polynomial.Polynomial(a @ axis)
    turns = along.deriv().roots()
    inner = turns[(np.abs(turns.imag) < SAME) & (turns.real > 0.0) & (turns.real < 1.0)].real
    places = np.array([0.0, *inner, 1.0])
    values = along(places)
    chosen = places[[int(values.argmin()), int(values.argmax())]]
    if chosen[0] > chosen[1]:
        chosen = chosen[::-1]
    return np.asarray(chosen[:, None] ** np.arange(len(a)) @ a)


def _in_plane(a: Array, axes: Array) -> Cubics:
    """Arcs of a plane cubic; in space they are found in its plane and put back."""
    origin = a[0]
    flat = cubic_arcs(np.array([np.zeros(2), *(a[1:] @ axes.T)]))
    return Cubics(
        flat.start @ axes + origin,
        flat.end @ axes + origin,
        flat.frame @ axes,
        flat.coefficients,
        flat.sense,
        flat.cotangent,
    )
