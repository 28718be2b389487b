r"""Multi-indices and the tables of truncated multiplication.

Notation: alpha = (alpha_1, ..., alpha_d), |alpha| = alpha_1 + ... + alpha_d, alpha! = prod alpha_i!.
The indices with |alpha| <= order are listed by degree, in descending lexicographic order inside a
degree: (0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2), ...  The list for a lower order is therefore the
beginning of the list for a higher one, so that truncation is slicing.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

MultiIndex = tuple[int, ...]
Pairs = tuple[tuple[int, int], ...]


@cache
def multi_indices(dim: int, order: int) -> tuple[MultiIndex, ...]:
    """List the multi-indices of `dim` entries with degree at most `order`, by degree.

    Parameters
    ----------
    dim
        Number of coordinates, at least 1.
    order
        Highest degree, at least 0.

    Returns
    -------
    tuple
        ``comb(dim + order, dim)`` indices, in the order of the module's docstring.
    """
    if dim < 1 or order < 0:
        raise ValueError(f"multi-indices need dim >= 1 and order >= 0, got dim={dim}, order={order}")
    return tuple(alpha for degree in range(order + 1) for alpha in _homogeneous(dim, degree))


def _homogeneous(dim: int, degree: int) -> list[MultiIndex]:
    if dim == 1:
        return [(degree,)]
    return [(k, *rest) for k in range(degree, -1, -1) for rest in _homogeneous(dim - 1, degree - k)]


def add(alpha: MultiIndex, beta: MultiIndex) -> MultiIndex:
    """Add two multi-indices."""
    return tuple(a + b for a, b in zip(alpha, beta, strict=True))


def factorial(alpha: MultiIndex) -> int:
    """Return alpha!, the product of the factorials of the entries."""
    return math.prod(math.factorial(a) for a in alpha)


@dataclass(frozen=True, eq=False)
class TaylorSpace:
    """Tables for polynomials in `dim` variables modulo degree `order` + 1.

    Attributes
    ----------
    indices
        The multi-indices, see :func:`multi_indices`.
    position
        Where an index stands in `indices`.
    factorials
        alpha! for every index.
    starts
        ``starts[k]`` is the position of the first index of degree k; ``starts[-1]`` is their number.
    products
        For every gamma the pairs of positions (alpha, beta) with alpha + beta = gamma.
    quotients
        The same without the pairs in which beta = 0 or alpha = 0.
    squares
        For every gamma the pairs with alpha before beta, and the position of gamma/2 or -1.
    """

    dim: int
    order: int
    indices: tuple[MultiIndex, ...]
    position: dict[MultiIndex, int]
    factorials: tuple[float, ...]
    starts: tuple[int, ...]
    products: tuple[Pairs, ...]
    quotients: tuple[Pairs, ...]
    squares: tuple[tuple[Pairs, int], ...]


@cache
def taylor_space(dim: int, order: int) -> TaylorSpace:
    """Return the (shared) tables for `dim` variables and degree at most `order`."""
    indices = multi_indices(dim, order)
    position = {alpha: i for i, alpha in enumerate(indices)}
    pairs: list[list[tuple[int, int]]] = [[] for _ in indices]
    for i, alpha in enumerate(indices):
        for j, beta in enumerate(multi_indices(dim, order - sum(alpha))):
            pairs[position[add(alpha, beta)]].append((i, j))
    return TaylorSpace(
        dim=dim,
        order=order,
        indices=indices,
        position=position,
        factorials=tuple(float(factorial(alpha)) for alpha in indices),
        starts=tuple(math.comb(dim + k - 1, dim) for k in range(order + 2)),
        products=tuple(tuple(p) for p in pairs),
        quotients=tuple(tuple((i, j) for i, j in p if i and j) for p in pairs),
        squares=tuple(
            (tuple((i, j) for i, j in p if i < j), next((i for i, j in p if i == j), -1)) for p in pairs
        ),
    )
