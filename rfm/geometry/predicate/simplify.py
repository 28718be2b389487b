"""Simplification of predicates: negation normal form, no duplicates, absorption.

Names become atoms of ``rfm.geometry.expression``, whose simplifications (``a & a = a``, ``a & (a | b) = a``,
``a & E = a & E[a := true]``) then do the work, and names that do not matter drop out (``a & b | a & ~b = a``).
Exclusive or, implication and equivalence are written with and, or, not first:

    a ^ b = (a & ~b) | (~a & b),    implies(a, b) = ~a | b,    iff(a, b) = (a & b) | (~a & ~b)

A Cartesian product is an atom too, with simplified factors.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import reduce, singledispatch

import numpy as np

from rfm.calculus.r_systems import RSystem
from rfm.calculus.r_systems import system as r_system
from rfm.calculus.types import Value
from rfm.errors import GeometryError
from rfm.geometry.expression import Conjunction, Expression, Literal, Node, assuming, conjunction
from rfm.geometry.predicate.formula import (
    And,
    Connective,
    Iff,
    Implies,
    Not,
    Or,
    Predicate,
    Product,
    Xor,
)
from rfm.geometry.shape import Shape
from rfm.geometry.surface import Surface

MOST_ATOMS = 14
"""Up to so many names those that do not matter are found, by trying all combinations."""

Atoms = dict[Predicate, Surface]


def simplified(predicate: Predicate) -> Predicate:
    """Equivalent predicate of ``& | ~`` (and products), negation at the names only, without repetitions.

    Raises
    ------
    GeometryError
        When the predicate holds nowhere or everywhere (found for up to 14 names).
    """
    atoms: dict[Predicate, Surface] = {}
    normal = _normal(predicate, atoms)
    if isinstance(normal, bool):
        where = "everywhere" if normal else "nowhere"
        raise GeometryError(f"the predicate {predicate} holds {where}: there is no boundary")
    back = {surface: atom for atom, surface in atoms.items()}
    return normal.walk(lambda surface, positive: _literal(back[surface], positive), _joined)


def shape(predicate: Predicate, shapes: Mapping[str, Shape]) -> Shape:
    """Substitute shapes for the names of the simplified predicate.

    Raises
    ------
    GeometryError
        When a name has no shape, dimensions do not fit, or the predicate holds nowhere or everywhere.
    """
    for name in predicate.names:
        if name not in shapes:
            raise GeometryError(f"no shape is called {name!r} (shapes: {', '.join(shapes) or 'none'})")
    found: Shape = simplified(predicate).evaluate(shapes)
    return found


@singledispatch
def _normal(predicate: Predicate, atoms: Atoms) -> Expression | bool:
    """Expression of a predicate; ``atoms`` collects what stands for names and products."""
    return Literal(atoms.setdefault(predicate, Surface((str(predicate),), _no_field)))


@_normal.register
def _(predicate: Product, atoms: Atoms) -> Expression | bool:
    atom = Product(tuple(map(simplified, predicate.of)), predicate.system)
    return Literal(atoms.setdefault(atom, Surface((str(atom),), _no_field)))


@_normal.register
def _(predicate: Not, atoms: Atoms) -> Expression | bool:
    return _negated(_normal(predicate.of, atoms))


@_normal.register
def _(predicate: And, atoms: Atoms) -> Expression | bool:
    return _both([_normal(term, atoms) for term in predicate.of], _system(predicate))


@_normal.register
def _(predicate: Or, atoms: Atoms) -> Expression | bool:
    return _either([_normal(term, atoms) for term in predicate.of], _system(predicate))


@_normal.register
def _(predicate: Xor, atoms: Atoms) -> Expression | bool:
    system = _system(predicate)
    return reduce(lambda a, b: _exclusive(a, b, system), [_normal(term, atoms) for term in predicate.of])


@_normal.register
def _(predicate: Implies, atoms: Atoms) -> Expression | bool:
    first, second = (_normal(term, atoms) for term in predicate.of)
    return _either([_negated(first), second], _system(predicate))


@_normal.register
def _(predicate: Iff, atoms: Atoms) -> Expression | bool:
    first, second = (_normal(term, atoms) for term in predicate.of)
    return _exclusive(first, _negated(second), _system(predicate))


def _exclusive(a: Expression | bool, b: Expression | bool, system: RSystem | None) -> Expression | bool:
    return _either([_both([a, _negated(b)], system), _both([_negated(a), b], system)], system)


def _negated(term: Expression | bool) -> Expression | bool:
    return not term if isinstance(term, bool) else term.negated()


def _both(terms: list[Expression | bool], system: RSystem | None) -> Expression | bool:
    rest = [term for term in terms if isinstance(term, Expression)]
    if False in terms:
        return False
    return _reduced(conjunction(rest, system)) if rest else True


def _either(terms: list[Expression | bool], system: RSystem | None) -> Expression | bool:
    return _negated(_both([_negated(term) for term in terms], system))


def _reduced(expression: Expression) -> Expression | bool:
    """Drop atoms on which the truth does not depend; a constant when it depends on none."""
    surfaces = expression.surfaces()
    if len(surfaces) > MOST_ATOMS:
        return expression
    signs = dict(zip(surfaces, 1 - 2 * np.indices((2,) * len(surfaces)), strict=True))
    truth = expression.evaluate(signs)
    for axis, surface in enumerate(surfaces):
        if (np.diff(truth, axis=axis) == 0).all():
            cofactor = assuming(expression, surface, True)
            return _reduced(cofactor) if isinstance(cofactor, Expression) else cofactor
    return expression


def _system(predicate: Connective) -> RSystem | None:
    return r_system(predicate.system) if isinstance(predicate.system, str) else predicate.system


def _literal(atom: Predicate, positive: bool) -> Predicate:
    return atom if positive else Not(atom)


def _joined(node: Node, terms: list[Predicate]) -> Predicate:
    return (And if isinstance(node, Conjunction) else Or)(tuple(terms), node.system)


def _no_field(*coords: Value) -> Value:
    raise TypeError("an atom of a predicate has no function; substitute a shape for it")
