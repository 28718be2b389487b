"""Value and derivatives of a shape's function at many points, fast and without compilation.

Three things make it fast, and none changes the result by more than rounding:

* **pruning**: the points are put into boxes, every surface is enclosed over every box (interval arithmetic),
  and in a minimum the terms that are certainly larger than another one are left out.  Only for minimum and
  maximum, where a term that loses decides nothing.  In R0 and its relatives every term counts everywhere,
  so there nothing is left out;
* **chunks** of points whose intermediate results stay in the cache;
* **threads**: NumPy releases the interpreter's lock, and the chunks are independent.

Notation: for w = f + g -+ s, s = sqrt(f^2 + g^2) (R0), ``grad w = (1 -+ f/s) grad f + (1 -+ g/s) grad g``.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from functools import reduce
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from rfm.calculus.jets import Jet, multi_indices, partials, variables
from rfm.calculus.r_systems import R0, R1, RSystem
from rfm.calculus.types import Array, Field
from rfm.errors import GeometryError
from rfm.geometry.expression import Conjunction, Expression, Literal, Node
from rfm.geometry.pruning import prune
from rfm.geometry.shape import Membership, Shape
from rfm.geometry.surface import Surface
from rfm.geometry.vanishing import Composition

CHUNK = 8192
"""Points at a time: some dozen arrays of them fit into a second-level cache."""

Task: TypeAlias = Callable[[], None]
Function: TypeAlias = Callable[[Surface], Field]
Linear: TypeAlias = tuple[Array | float, ...]
"""Value and first derivatives; numbers where they are constant."""


def sample(what: Shape | Field, points: Array, order: int = 1, threads: int | None = None) -> Array:
    """Evaluate a field and its partial derivatives at points.

    Parameters
    ----------
    what
        A field, or a shape, whose membership is meant.
    points
        Points, shape ``(n, d)``.
    order
        Highest derivative; 0 gives the values only.
    threads
        How many threads; by default the cores this process may use, but no more than ``OMP_NUM_THREADS``.

    Returns
    -------
    Array
        d^alpha f, shape ``(number of multi-indices, n)``, as of :func:`rfm.calculus.partials`.

    Raises
    ------
    GeometryError
        When the points are no finite array ``(n, d)`` of a shape's dimension, or no thread is allowed.
    """
    points = np.asarray(points, dtype=np.float64)
    if points.ndim != 2 or (isinstance(what, Shape) and points.shape[1] != what.dimension):
        wanted = f"(n, {what.dimension})" if isinstance(what, Shape) else "(n, d)"
        raise GeometryError(f"points must be an array {wanted}, got shape {points.shape}")
    if not np.isfinite(points).all():
        raise GeometryError("points must be finite")
    workers = default_threads() if threads is None else threads
    if workers < 1:
        raise GeometryError(f"threads must be at least 1, got {threads}")
    field = what.membership if isinstance(what, Shape) else what
    result = np.empty((len(multi_indices(points.shape[1], order)), len(points)))
    tasks = _tasks(field, points, order, result)
    if workers == 1:
        for task in tasks:
            task()
    else:
        with ThreadPoolExecutor(workers) as pool:
            for done in [pool.submit(task) for task in tasks]:
                done.result()
    return result


def _tasks(field: Field, points: Array, order: int, result: Array) -> Iterable[Task]:
    """Independent pieces of the work."""
    given = _taken_apart(field)
    if given is not None:
        expression, function, system = given
        if isinstance(system, R1):
            return _pruned_tasks(expression, function, points, order, result)
        if system == R0 and order <= 1:
            return _chunks(lambda coords: _r0(expression, function, coords, order), points, result)
    return _chunks(lambda coords: partials(field, coords, order), points, result)


def _taken_apart(field: Field) -> tuple[Expression, Function, RSystem | None] | None:
    """Expression, fields of its surfaces, and the system of R-functions, None when there are several."""
    if not isinstance(field, (Membership, Composition)):
        return None
    systems = field.expression.walk(
        lambda surface, positive: frozenset[RSystem](),
        lambda node, terms: frozenset[RSystem]({node.system or field.system}).union(*terms),
    )
    function = field.function if isinstance(field, Composition) else _own
    return field.expression, function, next(iter(systems)) if len(systems) == 1 else None


def _chunks(evaluate: Callable[[list[Array]], Array], points: Array, result: Array) -> Iterable[Task]:
    def task(piece: slice) -> Task:
        def run() -> None:
            result[:, piece] = evaluate([np.ascontiguousarray(x) for x in points[piece].T])

        return run

    return [task(slice(start, start + CHUNK)) for start in range(0, len(points), CHUNK)]


def _pruned_tasks(
    expression: Expression, function: Function, points: Array, order: int, result: Array
) -> Iterable[Task]:
    """One task for the points of all boxes in which the same terms are left."""

    def task(rest: Expression, chosen: NDArray[np.intp]) -> Task:
        field = Composition(rest, R1(), function)

        def run() -> None:
            for start in range(0, len(chosen), CHUNK):
                piece = chosen[start : start + CHUNK]
                result[:, piece] = partials(field, list(points[piece].T), order)

        return run

    return [task(rest, chosen) for rest, chosen in prune(expression, function, points)]


def _r0(expression: Expression, function: Function, coords: list[Array], order: int) -> Array:
    """Value and gradient (``order`` 1) of an R0-composition, in few passes over short arrays."""
    given = variables(coords, 1) if order else coords
    slopes = len(coords) * order

    def value(node: Expression) -> Linear:
        if isinstance(node, Literal):
            of_surface = _linear(function(node.surface)(*given), slopes)
            return of_surface if node.positive else tuple(-component for component in of_surface)
        if not isinstance(node, Node):
            raise TypeError("an expression is a Literal, a Conjunction or a Disjunction")
        sign = -1.0 if isinstance(node, Conjunction) else 1.0
        # one term after the other, so that few arrays are alive
        return reduce(lambda f, g: _pair(f, g, sign), map(value, node.terms))

    with np.errstate(divide="ignore", invalid="ignore"):
        total = value(expression)
    result = np.stack([np.broadcast_to(component, coords[0].shape) for component in total])
    # where both functions of a pair vanish, their direction is undefined: the careful rule decides
    return (
        result
        if np.isfinite(result).all()
        else partials(Composition(expression, R0, function), coords, order)
    )


def _linear(value: Jet | Array | float, slopes: int) -> Linear:
    return tuple(value.coefficients) if isinstance(value, Jet) else (value, *[0.0] * slopes)


def _pair(f: Linear, g: Linear, sign: float) -> Linear:
    """R0-conjunction (``sign`` -1) or -disjunction with its gradient."""
    a, b = np.asarray(f[0]), np.asarray(g[0])
    root, other = a * a, b * b
    root += other
    np.sqrt(root, out=root)
    value = a + b
    (np.subtract if sign < 0.0 else np.add)(value, root, out=value)
    if len(f) == 1:
        return (value,)
    inverse = np.divide(sign, root, out=root)
    of_f, of_g = a * inverse, np.multiply(b, inverse, out=inverse)
    of_f += 1.0
    of_g += 1.0
    return (value, *[_sum(of_f, p, of_g, q) for p, q in zip(f[1:], g[1:], strict=True)])


def _sum(a: Array, p: Array | float, b: Array, q: Array | float) -> Array | float:
    result = a * p
    result += b * q
    return result


def _own(surface: Surface) -> Field:
    return surface.function


def default_threads() -> int:
    """Cores this process may use, but no more than ``OMP_NUM_THREADS``."""
    allowed = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    limit = os.environ.get("OMP_NUM_THREADS", "")
    return max(1, min(allowed, int(limit))) if limit.isdigit() else allowed
