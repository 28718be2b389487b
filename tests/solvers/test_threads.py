"""Work done ahead in another thread: order, errors, and that no thread is started without need."""

from __future__ import annotations

import threading

import pytest

from solvers import threads
from solvers.threads import ahead


@pytest.fixture(params=[1, 2])
def cores(request, monkeypatch):
    """Number of threads the process may use."""
    monkeypatch.setattr(threads, "default_threads", lambda: request.param)
    return request.param


@pytest.mark.parametrize("count", [0, 1, 2, 5])
def test_items_come_in_order_with_their_values(cores, count):
    assert list(ahead(lambda k: k * k, iter(range(count)))) == [(k, k * k) for k in range(count)]


def test_a_single_item_stays_in_its_thread(cores):
    ((_, where),) = ahead(lambda _: threading.get_ident(), [0])
    assert where == threading.get_ident()


def test_several_items_go_to_another_thread_where_there_is_one(cores):
    where = {value for _, value in ahead(lambda _: threading.get_ident(), range(3))}
    assert (threading.get_ident() in where) == (cores == 1)


def test_no_more_than_the_next_value_is_computed_ahead(cores):
    begun = []
    steps = ahead(begun.append, range(9))
    next(steps)
    steps.close()
    assert len(begun) <= cores


def test_an_error_arrives_with_its_item(cores):
    steps = ahead(lambda k: 1 // (2 - k), range(4))
    assert [next(steps)[1], next(steps)[1]] == [0, 1]
    with pytest.raises(ZeroDivisionError):
        next(steps)
