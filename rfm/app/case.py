"""A case: the whole of one problem as the user states it, validated.

:func:`load_case` reads a case file, applies overrides and reports every mistake with its place.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path as FilePath
from typing import Annotated, Any

from pydantic import BeforeValidator, Field, PrivateAttr, ValidationInfo, WithJsonSchema, model_validator

from rfm.app.schema.base import Strict
from rfm.app.schema.conditions import BoundaryCondition
from rfm.app.schema.discretization import BASES, Discretization, Solver
from rfm.app.schema.equation import Equation
from rfm.app.schema.geometry import Geometry
from rfm.app.schema.results import UNKNOWNS, Expectation, Integral, Study
from rfm.app.schema.scalars import Text, Vector, check_name, fail, scope_of, shown
from rfm.app.schema.scope import scope_of_document
from rfm.app.schema.validation import validate
from rfm.app.schema.vectors import FieldData
from rfm.app.source import Document, from_file, from_mapping, nearest, raise_all
from rfm.app.yaml_reader import Path
from rfm.errors import CaseError

VERSION = 1

SUMMARY_KEYS = (
    "relative_l2_error",
    "relative_h1_error",
    "relative_max_error",
    "relative_energy_error",
    "boundary_error",
    "dofs",
    "energy",
    "linear",
    "integrals",
    "probes",
    "corners",
    "seconds",
    "peak_memory_mb",
    "memory_per_unknown",
)
"""Keys of a summary that can be expected; those with several values take a second name, as in ``probes.A.u``."""

ERROR_KEYS = SUMMARY_KEYS[:4]

MATRIX = "matrix"
"""Name of the material outside of all inclusions."""

LOWEST_DEGREES = {"plate": 2}
"""Least degree of the splines, where an equation has one."""


def _version(value: Any) -> int:
    if isinstance(value, bool) or value != VERSION:
        raise fail(f"this program reads schema version {VERSION}, got {shown(value)}")
    return VERSION


def _resolved_parameters(value: Any, info: ValidationInfo) -> Any:
    return dict(scope_of(info).parameters) if isinstance(value, dict) else value


class Case(Strict):
    """A boundary value problem and how to solve it."""

    rfm: Annotated[int, BeforeValidator(_version), WithJsonSchema({"const": VERSION})] = Field(
        description="schema version"
    )
    title: Text = Field(default="", description="one line for reports")
    parameters: Annotated[
        dict[str, float],
        BeforeValidator(_resolved_parameters),
        WithJsonSchema({"type": "object", "additionalProperties": {"type": ["number", "string"]}}),
    ] = Field(default_factory=dict, description="numbers by name, for use in every expression")
    geometry: Geometry
    equation: Equation
    boundary_conditions: list[BoundaryCondition]
    exact: FieldData | None = Field(
        default=None,
        description="exact solution, a list for a vector, by material where there are several: for the error norms",
    )
    discretization: Discretization = Field(default_factory=Discretization)
    solver: Solver = Field(default_factory=Solver)
    expect: dict[str, Expectation] = Field(default_factory=dict, description="limits for the summary")
    study: Study | None = Field(default=None, description="grids and degrees of rfm study")
    probes: dict[str, Vector] = Field(default_factory=dict, description="points by name")
    integrals: dict[str, Integral] = Field(default_factory=dict, description="integrals by name")

    _document: Document = PrivateAttr(default_factory=lambda: from_mapping({}))
    _name: str = PrivateAttr(default="case")
    _dimension: int = PrivateAttr(default=2)

    @model_validator(mode="after")
    def _consistent(self) -> Case:
        self._check_conditions()
        self._check_inclusions()
        self._check_exact()
        self._check_names()
        self._check_integrands()
        self._check_study()
        for key in self.expect:
            self._check_expected(key)
        return self

    def _check_conditions(self) -> None:
        name, vector = self.equation.name, self.is_vector
        for i, condition in enumerate(self.boundary_conditions):
            refusal = condition.refusal(name)
            if refusal is not None:
                raise fail(refusal, key=("boundary_conditions", i, condition.kind))
            if isinstance(condition.dirichlet, tuple) and not vector:
                path: Path = ("boundary_conditions", i, "dirichlet")
                raise fail(f"the unknown of {name} is a scalar: give one value, not a list", value=path)
        lowest = LOWEST_DEGREES.get(name, 1)
        if self.discretization.degree < lowest:
            raise fail(
                f"the equation {name} needs second derivatives of the splines: use degree {lowest} or more "
                f"({lowest + 1} is a good choice), got {self.discretization.degree}",
                value=("discretization", "degree"),
            )

    def _check_inclusions(self) -> None:
        """Names of materials and shapes, and that the exact solution is given for each."""
        names: list[str] = [MATRIX]
        for i, inclusion in enumerate(self.equation.inclusions):
            path: Path = ("equation", self.equation.name, "inclusions", i)
            for shape, offset in inclusion.region.names.items():
                if shape not in self.geometry.shapes:
                    message = f"unknown shape {shape!r}; {nearest(shape, self.geometry.shapes, 'shapes')}"
                    raise fail(message, value=(*path, "region"), offset=offset)
            if inclusion.called in names:
                raise fail(f"the name {inclusion.called!r} is taken; give another", value=path)
            names.append(inclusion.called)
        if not isinstance(self.exact, dict):
            return
        if not self.equation.inclusions:
            raise fail(
                "a mapping is for cases with inclusions; give the exact solution itself", value=("exact",)
            )
        for name in self.exact:
            if name not in names:
                message = f"unknown material {name!r}; {nearest(name, names, 'materials')}"
                raise fail(message, key=("exact", name))
        for name in names:
            if name not in self.exact:
                raise fail(f"the exact solution in {name!r} is missing", key=("exact",))

    def _check_exact(self) -> None:
        if self.exact is not None:
            parts = self.exact.items() if isinstance(self.exact, dict) else [(None, self.exact)]
            for name, part in parts:
                if isinstance(part, tuple) != self.is_vector:
                    wanted = (
                        "a list with one entry for each coordinate" if self.is_vector else "one expression"
                    )
                    place: Path = ("exact",) if name is None else ("exact", name)
                    raise fail(f"must be {wanted} for the equation {self.equation.name}", value=place)
            return
        if self.equation.exact_path is not None:
            path: Path = ("equation", self.equation.name, *self.equation.exact_path)
            raise fail("'from exact' needs the key exact", value=path)
        for i, condition in enumerate(self.boundary_conditions):
            if condition.from_exact:
                path = ("boundary_conditions", i, condition.kind)
                raise fail("'from exact' needs the key exact", value=path)
        for key in self.expect:
            if key in ERROR_KEYS:
                raise fail("an error can only be expected where the key exact is given", key=("expect", key))

    def _check_names(self) -> None:
        for section, what in (("probes", "probe"), ("integrals", "integral")):
            for name in getattr(self, section):
                wrong = check_name(name, what)
                if wrong:
                    raise fail(wrong, key=(section, name))

    def _check_integrands(self) -> None:
        for name, integral in self.integrals.items():
            if isinstance(integral.of, str):
                continue
            known = self.unknowns
            for wrong in sorted(integral.of.uses & set(UNKNOWNS) - set(known)):
                message = (
                    f"{wrong!r} has no value here; the unknown of {self.equation.name} is {', '.join(known)}"
                )
                raise fail(message, value=("integrals", name, "of"))

    def _check_study(self) -> None:
        basis = self.discretization.basis
        lowest, highest = BASES[basis]
        degrees = self.study.degree or () if self.study is not None else ()
        for wrong in (degree for degree in degrees if not lowest <= degree <= highest):
            message = f"must be from {lowest} to {highest}, got {wrong} (basis: {basis})"
            raise fail(message, value=("study", "degree"))

    def _check_expected(self, key: str) -> None:
        section, _, rest = key.partition(".")
        if section not in SUMMARY_KEYS:
            raise fail(
                f"unknown result {key!r}; {nearest(section, SUMMARY_KEYS, 'results')}", key=("expect", key)
            )
        if section in ("probes", "integrals"):
            known = getattr(self, section)
            name = rest.partition(".")[0]
            if name not in known:
                message = f"unknown result {key!r}; {nearest(name, known, section)}"
                raise fail(message, key=("expect", key))

    @property
    def is_vector(self) -> bool:
        """Whether the unknown is a vector."""
        return self.equation.elasticity is not None

    @property
    def unknowns(self) -> tuple[str, ...]:
        """Names of the unknown in an integrand."""
        if self.equation.elasticity is None:
            return UNKNOWNS[:1]
        return UNKNOWNS[1:] if self.equation.elasticity.model == "three_dimensional" else UNKNOWNS[1:3]

    @property
    def dimension(self) -> int:
        """Dimension of the shapes, 2 or 3."""
        return self._dimension

    @property
    def name(self) -> str:
        """Name of the case: that of its file without the ending."""
        return self._name

    @property
    def file(self) -> str:
        """File the case was read from, as the user named it; empty for a mapping."""
        return self._document.name

    def error(self, path: Path, message: str, *, offset: int | None = None, key: bool = False) -> CaseError:
        """Error at a path of the case, with file, line and column when it was read from a file."""
        return self._document.error(path, message, offset=offset, key=key)

    def discretized(self, *, degree: int, grid: int) -> Case:
        """Return the same case with another degree and grid."""
        update = {"degree": degree, "grid": grid, "spacing": None}
        return self.model_copy(update={"discretization": self.discretization.model_copy(update=update)})

    def to_dict(self) -> dict[str, Any]:
        """Return the resolved case as plain data that `load_case` reads again: every default filled in."""
        return self.model_dump(mode="json", exclude_none=True)


def load_case(source: str | FilePath | Mapping[str, Any], overrides: Mapping[str, Any] | None = None) -> Case:
    """Read and validate a case.

    Parameters
    ----------
    source
        Case file, or the data of a case as a mapping.
    overrides
        Values by dotted path, e.g. ``{"discretization.grid": 64}``.

    Raises
    ------
    CaseError
        The file cannot be read or the case is wrong; several mistakes are reported together.
    """
    document = from_mapping(source) if isinstance(source, Mapping) else from_file(source)
    return case_from_document(document, overrides or {})


def case_from_document(document: Document, overrides: Mapping[str, Any]) -> Case:
    """Validate the case of a document after applying overrides."""
    for key, value in overrides.items():
        document.override(key, value)
    for key, field in Case.model_fields.items():
        if not field.is_required() and document.data.get(key, ...) is None:
            del document.data[key]  # an empty section
    scope, errors = scope_of_document(document)
    case, more = validate(Case, document, scope)
    raise_all([*errors, *more])
    if case is None:
        raise CaseError("the case is empty", place=document.name)
    case._document = document
    case._name = _name_of(document, case)
    case._dimension = scope.dimension or 2
    return case


def _name_of(document: Document, case: Case) -> str:
    stem = FilePath(document.name).stem if document.name else case.title.lower()
    return re.sub(r"[^A-Za-z0-9._-]+", "-", stem).strip("-.")[:80] or "case"
