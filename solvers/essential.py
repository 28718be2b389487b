r"""Essential conditions as a solution structure, for scalars, vectors and plates.

Component c of u is

.. math:: u_c = g_c + \omega_c\, \psi_c, \qquad \omega_c = w_1\, w_2^2,

:math:`w_1` vanishing on the parts where its value is prescribed, :math:`w_2` where its slope is prescribed too (a
clamped edge); :math:`g_c` takes the data.  Each component has its own parts: a component left free (a roller) has no
weight there.  Slip, :math:`u \cdot N = 0` with :math:`N = \nabla w_s` on :math:`w_s = 0`, is

.. math:: u = v - \chi\, \frac{N \cdot v}{N \cdot N + w_s} N, \qquad \chi = \frac{w_d}{w_d + w_s},

for v as above and :math:`w_d` vanishing on all other essential parts.  The normal component is kept with a factor that
vanishes like :math:`w_s` to first order, so no derivative of it is lost.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import reduce

import numpy as np

from rfm.calculus.types import Field
from rfm.errors import DiscretizationError
from rfm.geometry.distance import distance
from rfm.geometry.part import Part
from rfm.geometry.shape import Shape
from rfm.geometry.weight import Weighting
from rfm.geometry.weight import weight as build_weight
from solvers.data import as_field
from solvers.exact import components_of, required
from solvers.problem import Clamped, Datum, Dirichlet, FromExact, Problem, SimplySupported, Slip
from structures.contact import finite_box
from structures.dirichlet import dirichlet
from structures.field_expression import ONE, ZERO, FieldExpr, differentiate, field, unit
from structures.manufactured import manufactured_extension
from structures.operator import Operator, known, unknown
from structures.transfinite import interpolate_derivatives

SAMPLES = 17
"""Points a direction at which the size of an exact solution is estimated."""


@dataclass(frozen=True, eq=False)
class Prescribed:
    """What is prescribed of one component on one part: its value, and perhaps its outward slope."""

    part: Part
    value: Datum | FromExact
    slope: Datum | FromExact | None = None

    @property
    def from_exact(self) -> bool:
        """Whether all of it is taken from the exact solution."""
        return isinstance(self.value, FromExact) and isinstance(self.slope, FromExact | None)


def essential_structure(problem: Problem, weight: Weighting | Field) -> tuple[Operator, ...]:
    """Structure of the essential conditions of `problem`, one operator for each component of u.

    Data taken from the exact solution are extended as ``exact + w q`` with a fixed generic q: the solver is
    told the values on the boundary, never the answer inside.

    Raises
    ------
    DiscretizationError
        The weight is a given function, and slopes are prescribed too.
    """
    domain = problem.domain
    count = problem.equation.components(domain.dimension)
    fields = tuple(_component(problem, prescribed(problem, c, count), weight, c) for c in range(count))
    slipping = [c.part for c in problem.conditions if isinstance(c, Slip)]
    if not slipping:
        return fields
    held = [c.part for c in problem.conditions if isinstance(c, Dirichlet)]
    return slipped(fields, domain, _joined(slipping), _joined(held) if held else None)


def prescribed(problem: Problem, component: int, count: int) -> list[Prescribed]:
    """What the conditions prescribe of one of the `count` components."""
    found = []
    for condition in problem.conditions:
        match condition:
            case Dirichlet(part=part, value=tuple() as values) if values[component] is not None:
                found.append(Prescribed(part, values[component]))
            case Dirichlet(part=part, value=value) if not isinstance(value, tuple):
                found.append(Prescribed(part, value))
            case SimplySupported(part=part, value=value):
                found.append(Prescribed(part, value))
            case Clamped(part=part, value=value, slope=slope):
                found.append(Prescribed(part, value, slope))
    return found


def slipped(fields: Sequence[Operator], domain: Shape, part: Part, held: Part | None) -> tuple[Operator, ...]:
    """Return `fields` without their component along the normal of `part`, unchanged on `held`.

    Parameters
    ----------
    fields
        One operator for each coordinate.
    domain
        The shape.
    part
        Where the body slips.
    held
        The other parts with essential conditions.
    """
    dimension = domain.dimension
    w = field(distance(domain, part))
    normal = [differentiate(w, unit(dimension, axis)) for axis in range(dimension)]
    along: Operator = known(dimension, 0.0)
    length: FieldExpr = w
    for slope, u in zip(normal, fields, strict=True):
        along = along + slope * u
        length = length + slope * slope
    chi = ONE
    if held is not None:
        other = field(build_weight(domain, held))
        chi = other / (other + w)
    factor = chi / length
    return tuple(u - (factor * slope) * along for slope, u in zip(normal, fields, strict=True))


def _component(
    problem: Problem, pieces: Sequence[Prescribed], weight: Weighting | Field, index: int
) -> Operator:
    domain = problem.domain
    if not pieces:
        return unknown(domain.dimension, index)
    exact = _exact_component(problem, index)
    if all(piece.slope is None for piece in pieces):
        return _valued(domain, pieces, exact, weight, index)
    vanishing = _weight(domain, pieces, weight)
    return _data(domain, pieces, exact, vanishing, weight) + vanishing * unknown(domain.dimension, index)


def _valued(
    domain: Shape, pieces: Sequence[Prescribed], exact: Field | None, weight: Weighting | Field, index: int
) -> Operator:
    """Structure of values alone."""
    manufactured = [piece.part for piece in pieces if isinstance(piece.value, FromExact)]
    data: list[tuple[Part, Field]] = [
        (piece.part, as_field(piece.value)) for piece in pieces if not isinstance(piece.value, FromExact)
    ]
    if manufactured:
        vanishing = weight if callable(weight) else build_weight(domain, _joined(manufactured), weight)
        extended = _extended(_known(exact), vanishing, domain)
        data += [(part, extended) for part in manufactured]
    return renamed(dirichlet(domain, data, weight=weight), index)


def _weight(domain: Shape, pieces: Sequence[Prescribed], weight: Weighting | Field) -> FieldExpr:
    """Return w_1 w_2^2."""
    if callable(weight):
        raise DiscretizationError(
            "a weight given as a function serves prescribed values, not slopes: give the name of a weight"
        )
    result = ONE
    for clamped, power in ((False, 1), (True, 2)):
        parts = [piece.part for piece in pieces if (piece.slope is not None) == clamped]
        if parts:
            result = result * field(build_weight(domain, _joined(parts), weight)) ** power
    return result


def _data(
    domain: Shape,
    pieces: Sequence[Prescribed],
    exact: Field | None,
    vanishing: FieldExpr,
    weight: Weighting | Field,
) -> FieldExpr:
    """Return g: one formula where one serves, else transfinite interpolation of Taylor polynomials, (7.12)."""
    if all(_is_zero(piece.value) and _is_zero(piece.slope) for piece in pieces):
        return ZERO
    if all(piece.from_exact for piece in pieces):
        return _extended(_known(exact), vanishing, domain)
    data = []
    for piece in _merged(pieces):
        w = distance(domain, piece.part)
        values: list[Field | FieldExpr | float] = [_resolved(piece.value, exact)]
        if isinstance(piece.slope, FromExact):
            # along the normal into the domain, where grad w points
            values.append(_normal_slope(_known(exact), field(w), domain.dimension))
        elif piece.slope is not None:
            values.append(-1.0 * field(piece.slope))
        data.append((values, w))
    return interpolate_derivatives(data, domain.dimension)


def _extended(exact: Field, vanishing: Field, domain: Shape) -> FieldExpr:
    """Return ``exact + w q`` with q of order one, or of the size of a smaller exact solution."""
    box = finite_box(domain.box)
    lattice = [np.linspace(low, high, SAMPLES) for low, high in zip(box.lower, box.upper, strict=True)]
    coords = np.meshgrid(*lattice, indexing="ij")
    with np.errstate(all="ignore"):
        values = np.abs(np.broadcast_to(exact(*coords), coords[0].shape))
        counted = np.isfinite(values) & (np.asarray(domain.sign(*coords)) > 0)
    size = float(values[counted].max(initial=0.0))
    scale = min(1.0, size) if size > 0 else 1.0
    return manufactured_extension(exact, scale * field(vanishing), domain.box)


def _merged(pieces: Sequence[Prescribed]) -> list[Prescribed]:
    """Join the parts of equal data."""
    found: dict[tuple[object, object], Prescribed] = {}
    for piece in pieces:
        key = (piece.value, piece.slope)
        known_piece = found.get(key)
        found[key] = piece if known_piece is None else replace(piece, part=known_piece.part | piece.part)
    return list(found.values())


def _normal_slope(exact: Field, w: FieldExpr, dimension: int) -> FieldExpr:
    total = ZERO
    for axis in range(dimension):
        step = unit(dimension, axis)
        total = total + differentiate(w, step) * differentiate(field(exact), step)
    return total


def renamed(operator: Operator, index: int) -> Operator:
    """Return an operator of the one unknown 0 as one of the unknown `index`."""
    return replace(operator, terms=tuple(replace(term, psi=index) for term in operator.terms))


def _exact_component(problem: Problem, index: int) -> Field | None:
    return None if problem.exact is None else components_of(problem.exact)[index]


def _resolved(datum: Datum | FromExact, exact: Field | None) -> Datum:
    return _known(exact) if isinstance(datum, FromExact) else datum


def _known(exact: Field | None) -> Field:
    return components_of(required(exact))[0]


def _is_zero(datum: Datum | FromExact | None) -> bool:
    return datum is None or (isinstance(datum, int | float) and datum == 0)


def _joined(parts: Sequence[Part]) -> Part:
    return reduce(lambda a, b: a | b, parts)
