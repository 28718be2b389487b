"""What a case may use, by topic: the content of `rfm list`."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from pydantic import BaseModel

from rfm.app.expressions import CONSTANTS, FUNCTIONS
from rfm.app.schema.conditions import BoundaryCondition
from rfm.app.schema.discretization import BASES, LINEAR_SOLVERS
from rfm.app.schema.equation import Equation
from rfm.app.schema.shapes import KINDS

CASES = Path("cases")


@dataclass(frozen=True)
class Topic:
    """A list: its columns and a function that makes its rows."""

    columns: tuple[str, ...]
    rows: Callable[[], list[tuple[str, ...]]]


def first_line(thing: object) -> str:
    """First line of a docstring."""
    return (inspect.getdoc(thing) or "").split("\n")[0]


def keys(model: type[BaseModel]) -> str:
    """Keys of a model; those with a default in brackets."""
    fields = model.model_fields.items()
    return ", ".join(name if field.is_required() else f"[{name}]" for name, field in fields)


def shapes() -> list[tuple[str, ...]]:
    """Kinds of shape with their arguments."""
    words = {0: "2D, 3D", 2: "2D", 3: "3D"}
    return [(name, words[kind.dimension], keys(kind), first_line(kind)) for name, kind in KINDS.items()]


def functions() -> list[tuple[str, ...]]:
    """Functions and constants of expressions."""
    rows = [(name, function.arity, function.meaning) for name, function in FUNCTIONS.items()]
    return [*rows, *((name, "constant", f"{value:.15g}") for name, value in CONSTANTS.items())]


def equations() -> list[tuple[str, ...]]:
    """Equations with their data and conditions."""
    conditions = ", ".join(n for n in BoundaryCondition.model_fields if n not in ("on", "where"))
    rows: list[tuple[str, ...]] = []
    for name, field in Equation.model_fields.items():
        model = field.annotation
        if isinstance(model, type) and issubclass(model, BaseModel):
            rows.append((name, keys(model), conditions, first_line(model)))
    return rows


def structures() -> list[tuple[str, ...]]:
    """Solution structures: how the conditions are carried."""
    return [
        ("dirichlet", "u = g + w psi", "exact on every part with a Dirichlet condition; w is the weight"),
        ("transfinite", "g = sum g_i w_i", "joins different Dirichlet data on different parts"),
        ("natural", "u = psi", "Neumann and Robin conditions, through the energy"),
    ]


def bases() -> list[tuple[str, ...]]:
    """Spline bases."""
    meaning = {
        "web-spline": "splines with little support inside are attached to inner ones: stable on any cut",
        "b-spline": "all splines that meet the domain: ill-conditioned where the boundary cuts off slivers",
    }
    return [(name, meaning[name]) for name in BASES]


def weights() -> list[tuple[str, ...]]:
    """Weights of the Dirichlet conditions."""
    from rfm.calculus.r_systems import NAMES

    rows = [
        ("auto", "product of the factors; saturated where many factors meet"),
        ("product", "raw product of the factors of an intersection"),
        ("saturated", "product of f / sqrt(f^2 + d^2), d the size of the feature"),
    ]
    return [*rows, *((name, "R-functions of the whole expression") for name in NAMES)]


def solvers() -> list[tuple[str, ...]]:
    """Linear solvers."""
    meaning = {
        "auto": "chosen by size and density; the summary says which and why",
        "dense": "Cholesky factorisation of the full matrix",
        "superlu": "sparse factorisation",
        "pardiso": "sparse factorisation by pypardiso, when that is installed",
        "cg": "conjugate gradients with diagonal scaling",
        "amg": "conjugate gradients with algebraic multigrid",
    }
    return [(name, meaning[name]) for name in LINEAR_SOLVERS]


def cases() -> list[tuple[str, ...]]:
    """Case files of the folder `cases` here, or of the source tree this program runs from."""
    folder = CASES if CASES.is_dir() else Path(__file__).resolve().parents[2] / CASES
    return [(str(file), _title(file)) for file in sorted(folder.rglob("*.yaml"))]


def _title(file: Path) -> str:
    from rfm.app.source import from_file
    from rfm.errors import RfmError

    try:
        return str(from_file(file).data.get("title", ""))
    except RfmError as error:
        return f"({error.args[0]})"


TOPICS: dict[str, Topic] = {
    "shapes": Topic(("kind", "dimension", "arguments", "meaning"), shapes),
    "functions": Topic(("function", "arguments", "meaning"), functions),
    "equations": Topic(("equation", "data", "conditions", "meaning"), equations),
    "structures": Topic(("structure", "formula", "meaning"), structures),
    "bases": Topic(("basis", "meaning"), bases),
    "weights": Topic(("weight", "meaning"), weights),
    "solvers": Topic(("linear solver", "meaning"), solvers),
    "cases": Topic(("case", "title"), cases),
}
