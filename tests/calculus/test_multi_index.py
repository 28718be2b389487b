"""Multi-indices: order of the list, tables of truncated products."""

import math

import pytest

from rfm.calculus.multi_index import multi_indices, taylor_space


def test_graded_order_in_two_and_three_variables() -> None:
    assert multi_indices(2, 2) == ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2))
    assert multi_indices(3, 1) == ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))
    assert multi_indices(3, 2)[4:] == ((2, 0, 0), (1, 1, 0), (1, 0, 1), (0, 2, 0), (0, 1, 1), (0, 0, 2))


@pytest.mark.parametrize("dim", [1, 2, 3, 4])
@pytest.mark.parametrize("order", [0, 1, 3, 5])
def test_list_is_complete_and_a_beginning_of_the_next(dim: int, order: int) -> None:
    indices = multi_indices(dim, order)
    assert len(set(indices)) == len(indices) == math.comb(dim + order, dim)
    assert multi_indices(dim, order + 1)[: len(indices)] == indices
    degrees = [sum(alpha) for alpha in indices]
    assert degrees == sorted(degrees)
    starts = taylor_space(dim, order).starts
    assert [degrees.index(k) for k in range(order + 1)] == list(starts[:-1])
    assert starts[-1] == len(indices)


@pytest.mark.parametrize(("dim", "order"), [(1, 6), (2, 4), (3, 3)])
def test_every_product_of_two_monomials_appears_once(dim: int, order: int) -> None:
    space = taylor_space(dim, order)
    pairs = [(i, j) for row in space.products for i, j in row]
    assert len(set(pairs)) == len(pairs) == math.comb(2 * dim + order, 2 * dim)
    for gamma, row, (mixed, half) in zip(space.indices, space.products, space.squares, strict=True):
        for i, j in row:
            total = tuple(a + b for a, b in zip(space.indices[i], space.indices[j], strict=True))
            assert total == gamma
        both = set(mixed) | {(j, i) for i, j in mixed} | ({(half, half)} if half >= 0 else set())
        assert both == set(row)


@pytest.mark.parametrize(("dim", "order"), [(0, 1), (2, -1)])
def test_senseless_arguments_are_refused(dim: int, order: int) -> None:
    with pytest.raises(ValueError, match="dim >= 1"):
        multi_indices(dim, order)
