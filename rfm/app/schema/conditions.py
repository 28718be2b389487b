"""The section `boundary_conditions`: what holds on which part of the boundary."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, ClassVar

from pydantic import BeforeValidator, Field, GetJsonSchemaHandler, ValidationInfo, model_validator
from pydantic_core import CoreSchema

from rfm.app.expressions import Expression
from rfm.app.schema.base import Strict
from rfm.app.schema.periodic import PeriodicData
from rfm.app.schema.scalars import FROM_EXACT, Comparison, Datum, DatumOrExact, PartNames, fail, shown
from rfm.app.schema.vectors import Components, ComponentsOrExact, Prescribed
from rfm.app.yaml_reader import Path

ZERO = Expression("0")

KINDS_OF = {
    "poisson": ("dirichlet", "neumann", "robin", "oblique", "periodic"),
    "elasticity": ("dirichlet", "traction", "pressure", "slip", "periodic"),
    "plate": ("clamped", "simply_supported", "free", "periodic"),
}
"""Kinds of condition by equation."""

KIND_NAMES = tuple(dict.fromkeys(name for names in KINDS_OF.values() for name in names))


class RobinData(Strict):
    """Coefficient h and value g of k du/dn + h u = g."""

    coefficient: Datum
    value: DatumOrExact


class ObliqueData(Strict):
    """Direction b, coefficient h and value g of b . grad u + h u = g."""

    direction: Components
    coefficient: Datum = ZERO
    value: DatumOrExact

    @model_validator(mode="after")
    def _has_length(self) -> ObliqueData:
        if all(component.constant == 0 for component in self.direction):
            raise fail(
                "must not be zero: give the direction of the derivative, e.g. [1, 0.5]", value=("direction",)
            )
        return self


class Edge(Strict):
    """Edge of a plate: `true` where nothing but zeros is prescribed, `from exact`, or the data by name."""

    @model_validator(mode="before")
    @classmethod
    def _short(cls, value: Any) -> Any:
        if value == FROM_EXACT:
            return dict.fromkeys(cls.model_fields, FROM_EXACT)
        if value is True:
            return {}
        if not isinstance(value, dict):
            names = ", ".join(f"{name}: ..." for name in cls.model_fields)
            raise fail(f"must be true, 'from exact' or {{{names}}}, got {shown(value)}")
        return value

    @classmethod
    def __get_pydantic_json_schema__(cls, core: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        """Allow the short forms."""
        short = [{"const": True}, {"const": FROM_EXACT}]
        return {"anyOf": [*short, handler.resolve_ref_schema(handler(core))]}


class ClampedEdge(Edge):
    """Deflection and slope dw/dn, n outward."""

    value: DatumOrExact = ZERO
    slope: DatumOrExact = ZERO


class SupportedEdge(Edge):
    """Deflection and bending moment."""

    value: DatumOrExact = ZERO
    moment: DatumOrExact = ZERO


class FreeEdge(Edge):
    """Bending moment and Kirchhoff's shear force."""

    moment: DatumOrExact = ZERO
    shear: DatumOrExact = ZERO


def _slip(value: Any) -> bool:
    if value is not True:
        raise fail(f"must be true (u . n = 0, no tangential traction), got {shown(value)}")
    return True


class BoundaryCondition(Strict):
    """One condition on a part, several parts, `all`, or the `rest` that no other condition takes."""

    refused: ClassVar[dict[str, str]] = {
        "extension": f"extension is not available; the conditions are: {', '.join(KIND_NAMES)}"
    }

    on: PartNames = Field(description="part, list of parts, all, or rest")
    where: Comparison | None = Field(default=None, description="comparison: only the piece where it holds")
    dirichlet: Prescribed | None = Field(
        default=None, description="u = value; a list for a vector, null leaves a component free"
    )
    neumann: DatumOrExact | None = Field(default=None, description="k du/dn = value, n outward")
    robin: RobinData | None = Field(default=None, description="k du/dn + coefficient * u = value")
    oblique: ObliqueData | None = Field(
        default=None, description="direction . grad u + coefficient * u = value, nowhere tangential"
    )
    traction: ComponentsOrExact | None = Field(default=None, description="sigma n = value, n outward")
    pressure: Datum | None = Field(default=None, description="sigma n = -value n, n outward")
    slip: Annotated[bool, BeforeValidator(_slip)] | None = Field(default=None, description="u . n = 0")
    clamped: ClampedEdge | None = Field(default=None, description="w = value, dw/dn = slope")
    simply_supported: SupportedEdge | None = Field(default=None, description="w = value, M = moment")
    free: FreeEdge | None = Field(default=None, description="M = moment, V = shear")
    periodic: PeriodicData | None = Field(
        default=None, description="u(x + T) = factor u(x) between two opposite parts"
    )

    @model_validator(mode="after")
    def _one_kind(self, info: ValidationInfo) -> BoundaryCondition:
        self.one_of(KIND_NAMES, "a condition")
        for name in ("all", "rest"):
            if name in self.on and len(self.on) > 1:
                raise fail(f"{name!r} stands alone, it cannot be combined with other parts", value=("on",))
        if "rest" in self.on and self.where is not None:
            raise fail("'rest' takes what is left and has no where; name the parts instead", key=("where",))
        if self.periodic is not None and self.where is not None:
            raise fail("a periodic condition holds on whole parts and has no where", key=("where",))
        if self.periodic is not None and {"all", "rest"} & set(self.on):
            raise fail(
                "a periodic condition joins two parts: name the one here, the other in 'with'", value=("on",)
            )
        return self

    @property
    def kind(self) -> str:
        """Name of the condition, e.g. dirichlet."""
        return next(name for name in KIND_NAMES if getattr(self, name) is not None)

    @property
    def from_exact(self) -> bool:
        """Whether some of its data are taken from the exact solution."""
        return FROM_EXACT in (value for _, value in self.data())

    def data(self) -> Iterator[tuple[Path, Any]]:
        """Data of the condition with their paths below it: expressions, 'from exact', or None."""
        yield from leaves((self.kind,), getattr(self, self.kind))

    def refusal(self, equation: str) -> str | None:
        """Why the condition does not suit an equation, None when it does."""
        kinds = KINDS_OF[equation]
        if self.kind in kinds:
            return None
        listed = ", ".join(kinds)
        if equation == "plate":
            return (
                f"a plate needs two conditions at every point of its boundary, {self.kind} is only one; its "
                f"conditions are: {listed}"
            )
        return f"the equation {equation} has no condition {self.kind}; its conditions are: {listed}"


def leaves(path: Path, value: Any) -> Iterator[tuple[Path, Any]]:
    """Values of the parts of `value`, a model or a list, with their paths."""
    if isinstance(value, Strict):
        for name, item in value:
            yield from leaves((*path, name), item)
    elif isinstance(value, tuple):
        for i, item in enumerate(value):
            yield from leaves((*path, i), item)
    else:
        yield path, value
