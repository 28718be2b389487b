r"""Sets of mixed dimension: regions together with curves, faces and points, such as a flag with its handle.

Notation: phi_i is positive inside region i, w >= 0 the joint function of the pieces of lower dimension.  One function
says everything ([1], example 4.2): the R-disjunction

    F = phi_1 v ... v phi_k v (-w).

*Contract*: F > 0 inside a region; F = 0 on the boundary of their union and on the pieces outside it; F < 0
elsewhere.  So the set is {F >= 0}, though it is not the closure of its interior.  With R_p and normalised
phi_i, F falls with unit slope on leaving a region, and on leaving a curve or a point to *every* side.

Reference: [1] Shapiro, Semi-analytic geometry with R-functions, Acta Numerica 16 (2007), section 4.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from rfm.calculus.functions import maximum
from rfm.calculus.r_systems import R0, RSystem
from rfm.calculus.types import Field, Value
from rfm.errors import GeometryError
from rfm.geometry.boundaries.pieces import Joined
from rfm.geometry.predicate import normalised_function
from rfm.geometry.shape import Shape


@dataclass(frozen=True, eq=False)
class MixedSet:
    """The field F of the module's docstring.

    Parameters
    ----------
    regions
        Fields, positive inside.
    pieces
        The part of lower dimension.
    system
        R-functions that join them.
    """

    regions: tuple[Field, ...]
    pieces: Joined
    system: RSystem = R0

    def __call__(self, *coords: Value) -> Value:
        """Value at the coordinates."""
        fields = [region(*coords) for region in self.regions]
        return self.system.disjunction(*fields, -self.pieces(*coords))

    def distance(self, *coords: Value) -> Value:
        """Zero on the whole set, with its regions, and positive elsewhere: ``max(-F, 0)``."""
        return maximum(-self(*coords), 0.0)


def mixed_set(regions: Sequence[Shape | Field], pieces: Joined, system: RSystem = R0) -> MixedSet:
    """Unite regions with pieces of lower dimension.

    Parameters
    ----------
    regions
        Shapes, or fields that are positive inside (:func:`rfm.geometry.boundaries.signed` gives such).
    pieces
        Curves, faces, points.
    system
        R-functions that join them; R_p keeps the normalisation to order p - 1.

    Raises
    ------
    GeometryError
        When there is no region (then the function of the pieces says everything), or Theorem 4 does not apply to a
        shape (then give a field for it).
    """
    if not regions:
        raise GeometryError("a set of mixed dimension needs a region; without one use the pieces alone")
    fields = tuple(normalised_function(r, system=system) if isinstance(r, Shape) else r for r in regions)
    return MixedSet(fields, pieces, system)
