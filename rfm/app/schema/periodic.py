"""The data of a periodic condition: the other part, the factor, the way from the one to the other."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

from pydantic import BeforeValidator, Field, ValidationInfo, WithJsonSchema, create_model

from rfm.app.schema.base import Strict
from rfm.app.schema.scalars import Number, PartNames, Vector, fail


def _factor(value: Any, info: ValidationInfo) -> Any:
    if isinstance(value, bool) or value not in (1, -1):
        raise fail("must be 1, or -1 of an antiperiodic field")
    return value


Factor = Annotated[Number, BeforeValidator(_factor), WithJsonSchema({"enum": [1, -1]})]


class Joining(Strict):
    """What joins two parts."""

    @property
    def partners(self) -> tuple[str, ...]:
        """Names of the parts on the other side."""
        names: tuple[str, ...] = getattr(self, "with")
        return names


if TYPE_CHECKING:

    class PeriodicData(Joining):
        """u(x + T) = factor u(x) for x on the part and x + T on the part `with`, with all derivatives."""

        factor: float
        shift: tuple[float, ...] | None

else:  # a key called `with` cannot be written as an attribute
    PeriodicData = create_model(
        "PeriodicData",
        __base__=Joining,
        __doc__="u(x + T) = factor u(x) for x on the part and x + T on the part `with`, with all derivatives.",
        **{
            "with": (PartNames, Field(description="the opposite part or parts")),
            "factor": (Factor, Field(default=1.0, description="1, or -1: antiperiodic")),
            "shift": (Vector | None, Field(default=None, description="T; found by itself")),
        },
    )
