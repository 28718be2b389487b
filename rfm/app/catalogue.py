"""What a case may use, by topic: the content of `rfm list`."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from pydantic import BaseModel

from rfm.app.expressions import CONSTANTS, FUNCTIONS
from rfm.app.schema.conditions import KINDS_OF
from rfm.app.schema.discretization import LINEAR_SOLVERS
from rfm.app.schema.equation import MODELS
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
    words = {0: "2D, 3D", 1: "1D", 2: "2D", 3: "3D"}
    return [(name, words[kind.dimension], keys(kind), first_line(kind)) for name, kind in KINDS.items()]


def functions() -> list[tuple[str, ...]]:
    """Functions and constants of expressions."""
    rows = [(name, function.arity, function.meaning) for name, function in FUNCTIONS.items()]
    return [*rows, *((name, "constant", f"{value:.15g}") for name, value in CONSTANTS.items())]


def equations() -> list[tuple[str, ...]]:
    """Equations with their data and conditions."""
    return [
        (name, keys(model), ", ".join(KINDS_OF[name]), first_line(model)) for name, model in MODELS.items()
    ]


def structures() -> list[tuple[str, ...]]:
    """Solution structures: what each satisfies for every psi, its psi's, what it asks of w, its derivatives of psi."""
    from structures.catalogue.registry import rows

    return rows()


def bases() -> list[tuple[str, ...]]:
    """Bases of the unknown psi with their degrees."""
    from solvers.bases.registry import BASES

    return [(name, "{} to {}".format(*one.degrees), one.meaning) for name, one in BASES.items()]


def weights() -> list[tuple[str, ...]]:
    """Weights of the Dirichlet conditions."""
    from rfm.calculus.r_systems import NAMES

    rows = [
        ("auto", "product of the factors; saturated where many factors meet"),
        ("product", "raw product of the factors of an intersection"),
        ("saturated", "product of f / sqrt(f^2 + d^2), d the size of the feature"),
        (
            "scaled:beta5:alpha2",
            "w / (1 + (5 |w|)^2), w the automatic weight; also with gamma, an exponent of it all",
        ),
        ("plateau:delta0.1:gamma3", "1 - max(0, 1 - dist/0.1)^3: one from the distance 0.1 on"),
    ]
    return [*rows, *((name, "R-functions of the whole expression") for name in NAMES)]


def methods() -> list[tuple[str, ...]]:
    """Methods that choose the unknown psi."""
    from solvers.methods import METHODS

    return [(name, first_line(method)) for name, method in METHODS.items()]


def solvers() -> list[tuple[str, ...]]:
    """Linear solvers."""
    meaning = {
        "auto": "chosen by size and density; the summary says which and why",
        "dense": "Cholesky factorisation of the full matrix",
        "pivoted": "Cholesky factorisation that leaves out dependent unknowns: for global bases",
        "superlu": "sparse factorisation",
        "pardiso": "sparse factorisation by pypardiso, when that is installed",
        "cg": "conjugate gradients with diagonal scaling",
        "ssor": "conjugate gradients with symmetric overrelaxation: low degree",
        "multigrid": "conjugate gradients with geometric multigrid of splines, any degree",
        "amg": "conjugate gradients with algebraic multigrid",
        "qr": "orthogonal factorisation of the rows: least-squares and collocation",
        "gmres": "GMRES with an incomplete factorisation: galerkin with advection",
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
    "structures": Topic(
        ("structure", "satisfies", "formula", "psi", "order of w", "derivatives"), structures
    ),
    "bases": Topic(("basis", "degree", "meaning"), bases),
    "weights": Topic(("weight", "meaning"), weights),
    "methods": Topic(("method", "meaning"), methods),
    "solvers": Topic(("linear solver", "meaning"), solvers),
    "cases": Topic(("case", "title"), cases),
}
