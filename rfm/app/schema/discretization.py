"""The sections `discretization` and `solver`: how the unknown is represented and computed."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar

from pydantic import BeforeValidator, Field, ValidationInfo, WithJsonSchema, model_validator

from rfm.app.schema.base import Strict
from rfm.app.schema.scalars import Corners, Positive, Truth, choice, fail, integer, scope_of, shown
from rfm.app.source import nearest
from rfm.errors import RfmError

BASES = ("web-spline", "b-spline")
LINEAR_SOLVERS = ("auto", "dense", "superlu", "pardiso", "cg", "amg")
DEFAULT_GRID = 32


def _weight(value: Any) -> str:
    from rfm.calculus import r_systems

    if not isinstance(value, str):
        raise fail(f"must be the name of a weight, got {shown(value)}")
    if value not in ("auto", "product", "saturated"):
        try:
            r_systems.system(value)
        except RfmError:
            names = ("auto", "product", "saturated", *r_systems.NAMES)
            raise fail(f"unknown name {value!r}; {nearest(value, names, 'weights')}") from None
    return value


Weight = Annotated[str, BeforeValidator(_weight), WithJsonSchema({"type": "string"})]


class Discretization(Strict):
    """Splines on a uniform grid of cells."""

    refused: ClassVar[dict[str, str]] = {"singular": "singular functions are not available; remove the key"}

    basis: choice(*BASES) = Field(default="web-spline", description="spline basis")  # type: ignore[valid-type]
    degree: integer(1, 8) = Field(default=3, description="degree of the splines")  # type: ignore[valid-type]
    grid: integer(1, 100_000) | None = Field(  # type: ignore[valid-type]
        default=None, description=f"cells along the longest side of the box ({DEFAULT_GRID} without spacing)"
    )
    spacing: Positive | None = Field(default=None, description="side of a cell, instead of grid")
    box: Corners | None = Field(default=None, description="background box; that of the domain by default")
    weight: Weight = Field(default="auto", description="weight of the Dirichlet conditions")
    quadrature_points: integer(1, 40) | None = Field(  # type: ignore[valid-type]
        default=None, description="Gauss points a direction in cut cells; degree + 3 by default"
    )
    moment_fitting: Truth = Field(default=True, description="fold cut cells into tensor rules")

    @model_validator(mode="after")
    def _one_size(self, info: ValidationInfo) -> Discretization:
        if self.grid is not None and self.spacing is not None:
            raise fail(
                "grid and spacing exclude each other; remove one (or set it to null)", key=("spacing",)
            )
        if self.box is not None and len(self.box[0]) != (scope_of(info).dimension or len(self.box[0])):
            raise fail(f"must have corners with {scope_of(info).dimension} coordinates", value=("box",))
        return self


class Solver(Strict):
    """The method and its linear solver."""

    refused: ClassVar[dict[str, str]] = {
        "conditions": "is not available: Dirichlet conditions are exact and the others natural; remove the key",
    }

    method: choice(  # type: ignore[valid-type]
        "ritz", missing={"least-squares": "the method least-squares is not available; the methods are: ritz"}
    ) = Field(default="ritz", description="ritz: least energy")
    linear: choice(*LINEAR_SOLVERS) = Field(  # type: ignore[valid-type]
        default="auto", description="linear solver"
    )
    tolerance: Positive = Field(default=1e-12, description="relative residual of iterative linear solvers")
