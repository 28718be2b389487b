r"""Element matrices by parity: what makes the assembly cheap.

A block of the bilinear form pairs :math:`\partial^\alpha B_i` with :math:`\partial^{\alpha'} B_j`. In one direction
the pair is :math:`\varphi^{(r)}_a \varphi^{(s)}_b`, which splits into a symmetric and an antisymmetric part,

.. math::

    \varphi^{(r)}_a \varphi^{(s)}_b = \tfrac12 (S^{rs}_{ab} + T^{rs}_{ab}), \qquad
    S^{rs}_{ab} = \varphi^{(r)}_a \varphi^{(s)}_b + \varphi^{(s)}_a \varphi^{(r)}_b, \quad
    T^{rs}_{ab} = \varphi^{(r)}_a \varphi^{(s)}_b - \varphi^{(s)}_a \varphi^{(r)}_b ,

with :math:`S^{rr} = \varphi^{(r)}_a \varphi^{(r)}_b` and no T when ``r = s``. S needs the pairs ``a <= b`` only, T the
pairs ``a < b``. Multiplied over the directions, a *parity* says which directions carry T. Adding a block and its
transpose cancels the odd parities and doubles the even ones. So a symmetric form without mixed second-order
terms, :math:`\int k \nabla u \nabla v + c u v` under any weight, consists of the parity SS..S alone, and its
element matrix has :math:`((p+1)(p+2)/2)^d` different entries instead of :math:`(p+1)^{2d}`: eight times fewer in
3D as p grows, in the contraction, the scatter and the storage alike.

A *kind* is the pair of orders and the sign of one direction's table, ``(r, s, +1)`` for S and ``(r, s, -1)`` for T,
``r <= s``; for the load vector it is ``(r,)``. A :class:`Form` lists, parity by parity, which coefficient arrays meet
which kinds.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from rfm.calculus.jets import multi_indices
from rfm.calculus.types import Array

Kind: TypeAlias = tuple[int, ...]
Kinds: TypeAlias = tuple[Kind, ...]
Parity: TypeAlias = tuple[int, ...]
Key: TypeAlias = Any  # (alpha, alpha') of a block, alpha of a load
Sources: TypeAlias = tuple[tuple[Key, float], ...]

MAX_ORDER = 8


@dataclass(frozen=True)
class Form:
    """One parity of a form: sums of coefficient arrays, and the tables each sum is contracted with.

    Attributes
    ----------
    parity
        +1 or -1 a direction; empty for a load vector.
    terms
        Kinds of the d directions, and the coefficient arrays (by key, with a factor) that meet them.
    order
        Highest derivative in the kinds.
    """

    parity: Parity
    terms: tuple[tuple[Kinds, Sources], ...]
    order: int


@dataclass(frozen=True)
class Pairs:
    """Index pairs of one direction: the lower number and the offset of the higher one."""

    lower: NDArray[np.intp]
    offset: NDArray[np.intp]


@lru_cache(maxsize=64)
def pairs(degree: int, sign: int) -> Pairs:
    """Pairs ``a <= b`` (sign +1) or ``a < b`` (sign -1) of local numbers 0..degree."""
    lower, upper = np.triu_indices(degree + 1, 0 if sign > 0 else 1)
    return Pairs(lower, upper - lower)


def table(phi: Array, kind: Kind) -> Array:
    """Table of a kind from the derivatives of the B-splines.

    Parameters
    ----------
    phi
        Derivatives, shape (order + 1, ..., p + 1).
    kind
        ``(r,)``, ``(r, s, +1)`` or ``(r, s, -1)``.

    Returns
    -------
    ndarray, shape (..., number of entries)
    """
    result: Array
    if len(kind) == 1:
        result = phi[kind[0]]
        return result
    r, s, sign = kind
    pair = pairs(phi.shape[-1] - 1, sign)
    upper = pair.lower + pair.offset
    result = phi[r][..., pair.lower] * phi[s][..., upper]
    if r != s:
        result += sign * phi[s][..., pair.lower] * phi[r][..., upper]
    return result


@lru_cache(maxsize=256)
def load_form(keys: tuple[int, ...], spacing: tuple[float, ...]) -> Form:
    """Form of the load vector with the given nonzero coefficients."""
    dimension = len(spacing)
    indices = _multi_indices(dimension, keys)
    terms = []
    for key in keys:
        alpha = indices[key]
        scale = _scale(spacing, alpha)
        terms.append((tuple((r,) for r in alpha), ((key, scale),)))
    return Form((), tuple(terms), max(max(indices[key]) for key in keys))


@lru_cache(maxsize=256)
def matrix_forms(
    keys: tuple[tuple[int, int], ...], spacing: tuple[float, ...], symmetric: bool = True
) -> tuple[Form, ...]:
    """Forms of the matrix with the given nonzero blocks, one a parity.

    With `symmetric` the block (alpha, alpha') also stands for (alpha', alpha), which is then not given itself.
    """
    indices = _multi_indices(len(spacing), itertools.chain.from_iterable(keys))
    found: dict[Parity, dict[Kinds, list[tuple[Key, float]]]] = {}
    for key in keys:
        alpha, other = indices[key[0]], indices[key[1]]
        scale = _scale(spacing, alpha) * _scale(spacing, other)
        choices = [_kinds(r, s) for r, s in zip(alpha, other, strict=True)]
        mixed = sum(len(choice) - 1 for choice in choices)
        twice = symmetric and key[0] != key[1]
        for kinds in itertools.product(*choices):
            parity = tuple(kind[2] for kind in kinds)
            if twice and np.prod(parity) < 0:
                continue
            sign = 1
            for kind, r, s in zip(kinds, alpha, other, strict=True):
                sign *= -1 if kind[2] < 0 and r > s else 1
            factor = sign * scale * 0.5**mixed * (2.0 if twice else 1.0)
            found.setdefault(parity, {}).setdefault(kinds, []).append((key, factor))
    order = max(max(indices[k]) for k in itertools.chain.from_iterable(keys))
    return tuple(
        Form(parity, tuple((kinds, tuple(sources)) for kinds, sources in sorted(terms.items())), order)
        for parity, terms in sorted(found.items(), reverse=True)
    )


@lru_cache(maxsize=256)
def entry_shifts(form_parity: Parity, degree: int, shape: tuple[int, ...]) -> NDArray[np.intp]:
    """Where the entries of an element go, relative to the flat index of its cell.

    A matrix entry with the lower index i and offset o is stored at ``o * size + i``, o and i flattened; a load
    entry at i.
    """
    strides = [int(np.prod(shape[axis + 1 :])) for axis in range(len(shape))]
    size = int(np.prod(shape))
    total = np.zeros(1, dtype=np.intp)
    for axis, stride in enumerate(strides):
        if form_parity:
            pair = pairs(degree, form_parity[axis])
            step = pair.lower * stride + pair.offset * (degree + 1) ** (len(shape) - 1 - axis) * size
        else:
            step = np.arange(degree + 1) * stride
        total = (total[:, None] + step).ravel()
    return total


def _kinds(r: int, s: int) -> Kinds:
    """Kinds that the pair of orders r and s splits into."""
    low, high = min(r, s), max(r, s)
    return ((r, r, 1),) if r == s else ((low, high, 1), (low, high, -1))


def _scale(spacing: Sequence[float], alpha: Sequence[int]) -> float:
    """Factor from derivatives on the unit span to physical ones."""
    return float(np.prod([h**-r for h, r in zip(spacing, alpha, strict=True)]))


def _multi_indices(dimension: int, keys: Iterable[int]) -> tuple[tuple[int, ...], ...]:
    """Multi-indices up to the highest key; their numbering does not depend on the order."""
    highest = max(keys)
    for order in range(MAX_ORDER + 1):
        indices = multi_indices(dimension, order)
        if len(indices) > highest:
            return indices
    raise ValueError(f"derivative number {highest} is of an order above {MAX_ORDER}")
