"""The sections `discretization` and `solver`: how the unknown is represented and computed."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BeforeValidator, Field, ValidationInfo, WithJsonSchema, model_validator

from rfm.app.schema.base import Strict
from rfm.app.schema.scalars import (
    Corners,
    Positive,
    Truth,
    choice,
    fail,
    integer,
    positive,
    scope_of,
    shown,
    within,
)
from rfm.app.source import nearest
from rfm.errors import RfmError

BASES = {
    "web-spline": (1, 8),
    "b-spline": (1, 8),
    "chebyshev": (1, 40),
    "legendre": (1, 40),
    "trigonometric": (1, 40),
    "radial": (1, 3),
}
"""Lowest and highest degree of each basis."""
HIGHEST = max(highest for _, highest in BASES.values())
METHODS = ("ritz", "least-squares", "galerkin", "collocation")
LINEAR_SOLVERS = (
    "auto",
    "dense",
    "pivoted",
    "superlu",
    "pardiso",
    "cg",
    "ssor",
    "multigrid",
    "amg",
    "qr",
    "gmres",
)
DEVICES = ("none", "cpu", "gpu")
CONDITIONS = ("natural", "exact")
SINGULAR = ("auto", "none", "corners")
DEFAULT_GRID = 32


def _weight(value: Any) -> str:
    from rfm.calculus import r_systems
    from rfm.geometry.weight import COMBINATIONS
    from rfm.geometry.weight_forms import FORMS, form

    if not isinstance(value, str):
        raise fail(f"must be the name of a weight, got {shown(value)}")
    try:
        if value not in COMBINATIONS and form(value) is None:
            r_systems.system(value)
    except RfmError as error:
        names = (*COMBINATIONS, *FORMS, *r_systems.NAMES)
        unknown = f"unknown name {value!r}; {nearest(value, names, 'weights')}"
        raise fail(unknown if str(error).startswith("unknown") else str(error)) from None
    return value


Weight = Annotated[str, BeforeValidator(_weight), WithJsonSchema({"type": "string"})]


def _degree(value: Any, info: ValidationInfo) -> int:
    basis = info.data.get("basis")
    lowest, highest = BASES[basis] if basis else (1, HIGHEST)  # a basis that is wrong has its own error
    if isinstance(value, bool) or not isinstance(value, int):
        raise fail(f"must be a whole number from {lowest} to {highest}, got {shown(value)}")
    if not lowest <= value <= highest:
        raise fail(f"must be from {lowest} to {highest}, got {value} (basis: {basis})")
    return value


Degree = Annotated[
    int,
    BeforeValidator(_degree),
    WithJsonSchema({"type": "integer", "minimum": 1, "maximum": HIGHEST}),
]


class Discretization(Strict):
    """The basis of the unknown on a uniform grid of cells."""

    basis: choice(*BASES) = Field(default="web-spline", description="basis of the unknown")  # type: ignore[valid-type]
    degree: Degree = Field(default=3, description="degree, as the basis counts it")
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
    singular: choice(*SINGULAR) = Field(  # type: ignore[valid-type]
        default="auto",
        description="singular functions at re-entrant corners: where possible, none, or refuse where impossible",
    )

    @model_validator(mode="after")
    def _one_size(self, info: ValidationInfo) -> Discretization:
        if self.grid is not None and self.spacing is not None:
            raise fail(
                "grid and spacing exclude each other; remove one (or set it to null)", key=("spacing",)
            )
        if self.box is not None and len(self.box[0]) != (scope_of(info).dimension or len(self.box[0])):
            raise fail(f"must have corners with {scope_of(info).dimension} coordinates", value=("box",))
        return self


def _weights(value: Any, info: ValidationInfo) -> tuple[float, ...]:
    if not isinstance(value, list | tuple) or not value:
        raise fail(f"must be a list of numbers, one for each equation, got {shown(value)}")
    return tuple(within(i, positive, item, info) for i, item in enumerate(value))


Weights = Annotated[
    tuple[float, ...],
    BeforeValidator(_weights),
    WithJsonSchema({"type": "array", "items": {"type": ["number", "string"]}, "minItems": 1}),
]


def _shards(value: Any) -> int | str:
    if value == "all":
        return "all"
    if isinstance(value, int) and not isinstance(value, bool) and value >= 1:
        return value
    raise fail(f"must be all or a positive whole number, got {shown(value)}")


Shards = Annotated[
    int | str,
    BeforeValidator(_shards),
    WithJsonSchema({"anyOf": [{"type": "integer", "minimum": 1}, {"const": "all"}]}),
]


class Solver(Strict):
    """The method and its linear solver."""

    method: choice(*METHODS) = Field(  # type: ignore[valid-type]
        default="ritz", description="what determines the splines: least energy, least residual, or weak form"
    )
    weights: Weights | None = Field(
        default=None, description="least-squares, collocation: weight of the residual of each equation"
    )
    boundary_weight: Positive | None = Field(
        default=None, description="least-squares, collocation: factor of the weights of natural conditions"
    )
    linear: choice(*LINEAR_SOLVERS) = Field(  # type: ignore[valid-type]
        default="auto", description="linear solver"
    )
    conditions: choice(*CONDITIONS) = Field(  # type: ignore[valid-type]
        default="natural", description="flux conditions through the functional, or exact by the structure"
    )
    device: choice(*DEVICES) = Field(  # type: ignore[valid-type]
        default="none", description="assembled matrix, or matrix-free conjugate gradients by JAX on a device"
    )
    shards: Shards | None = Field(
        default=None,
        description="devices that share the cells, or all; one by default, or all of several processes",
    )
    tolerance: Positive = Field(default=1e-12, description="relative residual of iterative linear solvers")
