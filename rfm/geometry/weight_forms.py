"""Forms of a weight: what is made of w, or of the distance, so that it levels off away from the boundary.

    scaled    (w / (1 + (beta |w|)^alpha))^gamma     of a weight w
    plateau   1 - max(0, 1 - dist/delta)^gamma       K. Hoellig, Finite Element Methods with B-Splines (SIAM 2003)

A plateau is 1 from the distance delta on: the solution is the spline itself there, and only a strip feels the
weight.  Both are asked for by name, ``scaled:beta5:alpha2``, ``plateau:delta0.1:gamma3``, wherever a weight is.

Smoothness.  The scaled weight is as smooth as w where alpha is an even integer; otherwise it has the smaller part of
alpha continuous derivatives across the boundary, which only rules with nodes beyond it see.  With gamma other than 1
it vanishes like dist^gamma, and psi = u / w is singular at a boundary where u vanishes like dist.  A plateau has
gamma - 1 continuous derivatives at the distance delta; psi inherits the kink, and the L2 error of degree p falls like
``h^min(p + 1, gamma + 1/2, 2 gamma - 1)``: what splines reach on the kink, and no more than duality gives.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass

from rfm.calculus.functions import absolute, guarded_power, maximum
from rfm.calculus.types import Field, Value
from rfm.errors import GeometryError
from rfm.geometry.checks import number, positive, shown

_NUMBER = r"(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?"


@dataclass(frozen=True, eq=False)
class Scaled:
    """``(w / (1 + (beta |w|)^alpha))^gamma``: zero like w^gamma, at most of the size of ``w^(1 - alpha)`` far off.

    Parameters
    ----------
    field
        The weight w.
    beta
        Inverse of the size of w at which it begins to level off; positive.
    alpha
        How sharply; positive, and 1 for a limit ``1/beta``.
    gamma
        Exponent of the whole, a positive integer: 2 for conditions on value and slope.

    Raises
    ------
    GeometryError
        When a parameter is out of range.
    """

    field: Field
    beta: float
    alpha: float = 2.0
    gamma: float = 1.0

    def __post_init__(self) -> None:
        """Check the parameters."""
        positive("beta", self.beta)
        positive("alpha", self.alpha)
        if number("gamma", self.gamma) < 1.0 or self.gamma != int(self.gamma):
            raise GeometryError(f"gamma must be a positive integer, got {shown(self.gamma)}")

    def __call__(self, *coords: Value) -> Value:
        """Value at the coordinates."""
        value = self.field(*coords)
        base = value * self.beta
        even = self.alpha % 2 == 0
        raised = base ** int(self.alpha) if even else guarded_power(absolute(base), self.alpha)
        return (value / (raised + 1.0)) ** int(self.gamma)


@dataclass(frozen=True, eq=False)
class Plateau:
    """``1 - max(0, 1 - dist/delta)^gamma``: slope ``gamma/delta`` at the boundary, 1 from the distance delta on.

    Parameters
    ----------
    distance
        Normalised to order one.
    delta
        Width of the strip; positive.
    gamma
        At least 1; one more than the number of continuous derivatives.

    Raises
    ------
    GeometryError
        When a parameter is out of range.
    """

    distance: Field
    delta: float
    gamma: float = 3.0

    def __post_init__(self) -> None:
        """Check the parameters."""
        positive("delta", self.delta)
        if number("gamma", self.gamma) < 1.0:
            raise GeometryError(f"gamma must be at least 1, got {shown(self.gamma)}")

    def __call__(self, *coords: Value) -> Value:
        """Value at the coordinates."""
        strip = maximum(1.0 - self.distance(*coords) * (1.0 / self.delta), 0.0)
        whole = int(self.gamma)
        return 1.0 - (strip**whole if whole == self.gamma else guarded_power(strip, self.gamma))


@dataclass(frozen=True)
class Form:
    """A form with its parameters, still without a field.

    Attributes
    ----------
    of_distance
        Whether it is applied to the distance rather than to the weight.
    """

    build: Callable[..., Field]
    parameters: tuple[tuple[str, float], ...]
    of_distance: bool

    def __call__(self, field: Field) -> Field:
        """Apply it."""
        return self.build(field, **dict(self.parameters))


@dataclass(frozen=True)
class _Kind:
    build: Callable[..., Field]
    required: str
    optional: tuple[str, ...]
    of_distance: bool

    @property
    def known(self) -> tuple[str, ...]:
        return (self.required, *self.optional)


FORMS: dict[str, _Kind] = {
    "scaled": _Kind(Scaled, "beta", ("alpha", "gamma"), of_distance=False),
    "plateau": _Kind(Plateau, "delta", ("gamma",), of_distance=True),
}


def form(name: str) -> Form | None:
    """Return the form with a name such as ``plateau:delta0.1:gamma3``; None when it names no form.

    Raises
    ------
    GeometryError
        When a parameter is missing, unknown or out of range.
    """
    head, *rest = name.strip().lower().split(":")
    kind = FORMS.get(head)
    if kind is None:
        return None
    given: dict[str, float] = {}
    for piece in rest:
        match = re.fullmatch(rf"([a-z]+)(-?{_NUMBER})", piece)
        if match is None or match[1] not in kind.known or match[1] in given:
            raise GeometryError(f"the weight {head} has no parameter {piece!r}; write {_example(head, kind)}")
        given[match[1]] = float(match[2])
    if kind.required not in given:
        raise GeometryError(f"the weight {head} needs {kind.required}; write {_example(head, kind)}")
    found = Form(kind.build, tuple(given.items()), kind.of_distance)
    found(lambda *coords: 0.0)  # checks the parameters
    return found


def _example(head: str, kind: _Kind) -> str:
    values = {"beta": "5", "alpha": "2", "gamma": "3" if kind.of_distance else "1", "delta": "0.1"}
    return ":".join([head, *(name + values[name] for name in kind.known)])
