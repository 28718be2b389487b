"""Maps of shapes: the image of a set under T is where its functions, taken at the preimage, are positive.

Notation: ``f`` is a surface function of the given shape, ``S`` the inverse map, so the image has the
functions ``c f(S(x))``; c, the *stretch*, is the least factor by which T lengthens, so that the slope on the
boundary stays at most that of f.  S may also lead to a space of another dimension (a solid of revolution,
an extrusion: ``f(S(x))`` then is the whole preimage of the profile under S).  Source: V. Shapiro,
Semi-analytic geometry with R-functions, Acta Numerica 16 (2007), section 6.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from rfm.calculus.types import Array, Field, Value
from rfm.geometry.carriers import Plane, plane
from rfm.geometry.shape import Shape
from rfm.geometry.support import Support
from rfm.geometry.surface import Piece, Surface


class Mapping(ABC):
    """A map of space, known by its inverse."""

    @property
    @abstractmethod
    def dimension(self) -> int:
        """Of the image."""

    @property
    def stretch(self) -> float:
        """Lower bound of the factor by which the map lengthens near the shape."""
        return 1.0

    @property
    def isometric(self) -> bool:
        """Whether ``stretch * f(back(x))`` is normalised when f is."""
        return False

    @abstractmethod
    def back(self, *coords: Value) -> tuple[Value, ...]:
        """Preimage of a point; values of any kind."""

    @abstractmethod
    def image(self, reach: Support) -> Support:
        """Support function of the image of a set, or an upper bound of it."""

    def surface(self, given: Surface) -> Surface:
        """Return the image of a surface, with its labels."""
        return replace(
            given,
            function=Pullback(given.function, self, self.stretch),
            degree=None,
            size=given.size * self.stretch,
            normalised=given.normalised and self.isometric,
            peak=given.peak * self.stretch,
            pieces=self.pieces(given),
        )

    def pieces(self, given: Surface) -> tuple[Piece, ...]:
        """Images of the named pieces of a surface."""
        return tuple(replace(piece, where=Pullback(piece.where, self)) for piece in given.pieces)


@dataclass(frozen=True, eq=False)
class Pullback:
    """The field ``factor * field(mapping.back(x))``."""

    field: Field
    mapping: Mapping
    factor: float = 1.0

    def __call__(self, *coords: Value) -> Value:
        """Value at the coordinates."""
        value = self.field(*self.mapping.back(*coords))
        return value if self.factor == 1.0 else self.factor * value


def mapped(shape: Shape, mapping: Mapping) -> Shape:
    """Image of a shape; labels and parts stay."""
    expression = shape.expression.mapped(mapping.surface)
    return Shape(mapping.dimension, expression, mapping.image(shape.reach), system=shape.system)


@dataclass(frozen=True, eq=False)
class LinearMapping(Mapping):
    """A map whose inverse is affine, ``back(x) = rows x + shift``: polynomials keep their degree.

    ``rows`` has shape (dimension of the given shape, dimension of the image); planes become planes with a
    unit normal, everything else is composed.
    """

    rows: Array
    shift: Array

    @property
    def dimension(self) -> int:
        """Of the image."""
        return int(self.rows.shape[1])

    @cached_property
    def forms(self) -> tuple[Plane, ...]:
        """The coordinates of the preimage as affine forms."""
        return tuple(plane(row, -float(shift)) for row, shift in zip(self.rows, self.shift, strict=True))

    @property
    def stretch(self) -> float:
        """One over the largest factor by which the inverse lengthens."""
        return 1.0 / float(np.linalg.norm(self.rows, 2))

    @property
    def isometric(self) -> bool:
        """Whether gradients keep their angles and, up to a common factor, their lengths."""
        gram = self.rows @ self.rows.T * self.stretch**2
        return bool(np.abs(gram - np.eye(len(gram))).max() < 1e-13)

    def back(self, *coords: Value) -> tuple[Value, ...]:
        """Preimage of a point."""
        return tuple(form(*coords) for form in self.forms)

    def surface(self, given: Surface) -> Surface:
        """Return the image of a surface, with its labels."""
        result = replace(super().surface(given), degree=given.degree)
        if isinstance(given.function, Plane):
            straight = self.plane(given.function)
            return replace(result, function=straight, normalised=given.normalised)
        return result

    def plane(self, given: Plane) -> Plane:
        """Image of a line or plane, with the slope that it had.

        Raises
        ------
        ZeroDivisionError
            When the form is constant on the image.
        """
        normal = np.array(given.normal)
        turned = normal @ self.rows
        factor = float(np.linalg.norm(normal)) / float(np.linalg.norm(turned))
        return plane(factor * turned, factor * (given.offset - float(normal @ self.shift)))
