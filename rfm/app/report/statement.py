"""The problem of a resolved case in words and formulas."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

Symbols = tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class Statement:
    """What is to be solved.

    Attributes
    ----------
    equation
        The equation, e.g. ``−Δu = f in Ω``.
    where
        Symbols and what they stand for.
    conditions
        One line per boundary condition.
    shapes
        Shapes and what they are, the domain last.
    """

    equation: str
    where: Symbols
    conditions: tuple[str, ...]
    shapes: Symbols


def state_problem(case: Mapping[str, Any]) -> Statement:
    """Formulate the problem of a resolved case."""
    name, data = next(iter(case.get("equation", {}).items()), ("", {}))
    writer = EQUATIONS.get(name, _any_equation)
    equation, where = writer(name, data)
    if case.get("exact") is not None:
        where = (*where, ("exact u", text(case["exact"])))
    where += tuple((f"{key}", text(value)) for key, value in case.get("parameters", {}).items())
    conditions = tuple(_condition(item) for item in case.get("boundary_conditions", ()))
    geometry = case.get("geometry", {})
    shapes = tuple((key, _shape(value)) for key, value in geometry.get("shapes", {}).items())
    return Statement(equation, where, conditions, (*shapes, ("Ω", text(geometry.get("domain", "")))))


def text(value: Any) -> str:
    """Plain text of a value of a case."""
    if isinstance(value, Mapping):
        return ", ".join(f"{key} {text(item)}" for key, item in value.items())
    if isinstance(value, Sequence) and not isinstance(value, str):
        return f"[{', '.join(text(item) for item in value)}]"
    return f"{value:.10g}" if isinstance(value, float) else str(value)


def is_number(value: Any, number: float) -> bool:
    """Whether a datum (a number or its text) is this number."""
    try:
        return float(value) == number
    except (TypeError, ValueError):
        return False


def _poisson(_: str, data: Mapping[str, Any]) -> tuple[str, Symbols]:
    conductivity, reaction = data.get("conductivity", 1), data.get("reaction", 0)
    where = [("f", text(data.get("source", 0)))]
    left = "−Δu"
    if not is_number(conductivity, 1):
        left = "−∇·(k ∇u)"
        where.append(("k", text(conductivity)))
    if data.get("advection") is not None:
        left += " + b·∇u"
        where.append(("b", text(data["advection"])))
    if not is_number(reaction, 0):
        left += " + c u"
        where.append(("c", text(reaction)))
    return f"{left} = f in Ω", (*where, *_materials(data))


def _materials(data: Mapping[str, Any]) -> Symbols:
    """What is other in each inclusion."""
    return tuple(
        (f"in {item.get('region')}", text({k: v for k, v in item.items() if k not in ("region", "name")}))
        for item in data.get("inclusions") or ()
    )


def _elasticity(_: str, data: Mapping[str, Any]) -> tuple[str, Symbols]:
    where = [("E", text(data.get("young_modulus"))), ("ν", text(data.get("poisson_ratio")))]
    force = data.get("body_force")
    if force is not None:
        where.append(("f", text(force)))
    model = str(data.get("model", "")).replace("_", " ")
    return f"−∇·σ(u) = {'0' if force is None else 'f'} in Ω ({model})", (*where, *_materials(data))


def _plate(_: str, data: Mapping[str, Any]) -> tuple[str, Symbols]:
    where = [("q", text(data.get("load"))), ("ν", text(data.get("poisson_ratio", 0.3)))]
    stiffness = data.get("stiffness", 1)
    if is_number(stiffness, 1):
        return "Δ²w = q in Ω", tuple(where)
    return "∇·∇·(D ∇∇w) = q in Ω", (*where, ("D", text(stiffness)))


def _any_equation(name: str, data: Mapping[str, Any]) -> tuple[str, Symbols]:
    items = data.items() if isinstance(data, Mapping) else ()
    return f"{name} in Ω", tuple((key, text(value)) for key, value in items)


EQUATIONS: dict[str, Callable[[str, Mapping[str, Any]], tuple[str, Symbols]]] = {
    "poisson": _poisson,
    "elasticity": _elasticity,
    "plate": _plate,
}
"""How each equation is written; others are listed by their data."""


def _condition(item: Mapping[str, Any]) -> str:
    kind = next((name for name in CONDITIONS if item.get(name) is not None), None)
    formula = CONDITIONS[kind](item[kind]) if kind else text(item)
    names = item.get("on", "all")
    part = names if isinstance(names, str) else ", ".join(names)
    piece = f" where {item['where']}" if item.get("where") else ""
    return f"{formula} on {part}{piece}"


def _robin(data: Mapping[str, Any]) -> str:
    return f"k ∂u/∂n + ({text(data.get('coefficient'))}) u = {text(data.get('value'))}"


def _periodic(data: Mapping[str, Any]) -> str:
    sign = "−" if is_number(data.get("factor", 1), -1) else ""
    partner = data.get("with", "")
    names = partner if isinstance(partner, str) else ", ".join(partner)
    return f"u(x + T) = {sign}u(x), with {names},"


def _oblique(data: Mapping[str, Any]) -> str:
    direction = ", ".join(text(component) for component in data.get("direction", ()))
    stiff = text(data.get("coefficient", 0))
    return f"({direction})·∇u{f' + ({stiff}) u' if stiff != '0' else ''} = {text(data.get('value'))}"


def _free(value: Any) -> Any:
    return ["free" if item is None else item for item in value] if isinstance(value, list) else value


CONDITIONS: dict[str, Callable[[Any], str]] = {
    "dirichlet": lambda value: f"u = {text(_free(value))}",
    "neumann": lambda value: f"k ∂u/∂n = {text(value)}",
    "robin": _robin,
    "oblique": _oblique,
    "traction": lambda value: f"σn = {text(value)}",
    "pressure": lambda value: f"σn = −({text(value)}) n",
    "slip": lambda _: "u·n = 0",
    "clamped": lambda data: f"w = {text(data.get('value', 0))}, ∂w/∂n = {text(data.get('slope', 0))}",
    "simply_supported": lambda data: f"w = {text(data.get('value', 0))}, M = {text(data.get('moment', 0))}",
    "periodic": _periodic,
    "free": lambda data: f"M = {text(data.get('moment', 0))}, V = {text(data.get('shear', 0))}",
}
"""How each condition is written."""


def _shape(data: Any) -> str:
    if not isinstance(data, Mapping) or len(data) != 1:
        return text(data)
    kind, arguments = next(iter(data.items()))
    return f"{kind}({text(arguments)})"
