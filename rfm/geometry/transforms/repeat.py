"""Repetition of a shape along a line: by copies, by a triangle wave, by its Fourier series.

Notation: u is the unit vector of the step, ``l`` its length, c the middle of the shape along u and
``t = u . x - c``; the folded point is ``x + (w(t) - t) u`` with

    w = triangle wave of half width l/2    exact; every other copy is mirrored; kinks at the walls between cells
    w = its Fourier series                 analytic, the copies are approximations

(Shapiro, Acta Numerica 2007, section 6: translational symmetry).  ``rfm.calculus.waves`` has the waves.  Copies are
a Boolean union instead: every copy keeps its own smooth functions, which is best for solving.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import reduce
from types import MappingProxyType

import numpy as np

from rfm.calculus.types import Array, Value
from rfm.calculus.waves import fold_series, triangle
from rfm.errors import GeometryError
from rfm.geometry import support
from rfm.geometry.carriers import plane
from rfm.geometry.checks import shown, vector
from rfm.geometry.shape import Shape
from rfm.geometry.support import Support
from rfm.geometry.transforms.mapping import Mapping, mapped

Wave = Callable[[Value], Value]


@dataclass(frozen=True, eq=False)
class Fold(Mapping):
    """The map ``x -> x + (wave(t) - t) u``; ``last`` is the vector to the last copy, None without end."""

    unit: Array
    middle: float
    wave: Wave
    last: Array | None = None

    @property
    def dimension(self) -> int:
        """Of the shape."""
        return len(self.unit)

    def back(self, *coords: Value) -> tuple[Value, ...]:
        """Folded point."""
        along = plane(self.unit, self.middle)(*coords)
        shift = self.wave(along) - along
        return tuple(
            x if component == 0.0 else x + component * shift
            for x, component in zip(coords, self.unit, strict=True)
        )

    def image(self, reach: Support) -> Support:
        """Reach of the shape and its mirror image, moved by all steps."""
        if self.last is None:
            return support.minkowski_sum(reach, support.line(0.0 * self.unit, self.unit))
        last = self.last

        def image(directions: Array) -> Array:
            along = directions @ self.unit
            mirrored = directions - 2.0 * along[:, None] * self.unit
            other = reach(mirrored) + 2.0 * self.middle * along
            return np.asarray(np.maximum(reach(directions), other) + np.maximum(0.0, directions @ last))

        return image


def repeat(of: Shape, step: Sequence[float] | Array, count: int, by: str = "copies") -> Shape:
    """Row of a shape: itself and ``count - 1`` more, a step apart.

    Parameters
    ----------
    of
        For ``wave`` it must not be longer than the step along the step.
    step
        Vector from one to the next.
    count
        Number of shapes, at least 2.
    by
        ``copies``: Boolean union of moved shapes.  ``wave``: one set of functions, folded by the triangle wave;
        every other shape is a mirror image.

    Raises
    ------
    GeometryError
        For a count below 2, a step of zero, an unknown way, or shapes that would overlap.
    """
    vectors = vector("step", step, of.dimension)
    length = float(np.linalg.norm(vectors))
    if length == 0.0:
        raise GeometryError("step must not be the zero vector")
    if count != int(count) or count < 2:
        raise GeometryError(f"count must be a whole number of at least 2, got {shown(count)}")
    if by not in WAYS:
        raise GeometryError(f"by must be one of {', '.join(WAYS)}, got {by!r}")
    return WAYS[by](of, vectors, int(count))


def repeat_series(of: Shape, step: Sequence[float] | Array, terms: int = 8) -> Shape:
    """Endless row of a shape by the Fourier series of the triangle wave: one analytic function for all.

    The shapes are approximations that get better with the number of ``terms``; intersect the row with
    something bounded.

    Raises
    ------
    GeometryError
        For a step of zero, shapes that would overlap, or less than one term.
    """
    vectors = vector("step", step, of.dimension)
    half = 0.5 * float(np.linalg.norm(vectors))
    if half == 0.0:
        raise GeometryError("step must not be the zero vector")
    if terms < 1:
        raise GeometryError(f"terms must be at least 1, got {shown(terms)}")
    unit, middle = _cell(of, vectors)
    return mapped(of, Fold(unit, middle, lambda t: fold_series(t, half, terms)))


def _copies(shape: Shape, step: Array, count: int) -> Shape:
    moved = [shape, *(shape.move((k * step).tolist()) for k in range(1, count))]
    return reduce(lambda first, second: first | second, moved)


def _wave(shape: Shape, step: Array, count: int) -> Shape:
    unit, middle = _cell(shape, step)
    half = 0.5 * float(np.linalg.norm(step))
    fold = Fold(unit, middle, lambda t: triangle(t, half, count - 1.0, 0.0), (count - 1.0) * step)
    return mapped(shape, fold)


def _cell(shape: Shape, step: Array) -> tuple[Array, float]:
    """Direction of the row and the middle of the first shape along it."""
    length = float(np.linalg.norm(step))
    unit = step / length
    high, low = float(shape.reach(unit[None, :])[0]), -float(shape.reach(-unit[None, :])[0])
    if not high - low <= length * (1.0 + 1e-12):
        raise GeometryError(
            f"the shape is {high - low:.6g} long in the direction of the step, longer than the step ({length:.6g}): "
            f"repeat it by copies"
        )
    return unit, 0.5 * (high + low)


WAYS: MappingProxyType[str, Callable[[Shape, Array, int], Shape]] = MappingProxyType(
    {"copies": _copies, "wave": _wave}
)
"""How a shape is repeated, by name."""
