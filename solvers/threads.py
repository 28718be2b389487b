"""Threads: how many the BLAS may use, and work that is done ahead in another one.

The matrices of a cell are small, and so is a system of a few hundred unknowns: starting a second BLAS thread costs more
than it gives, and on a busy machine its threads wait for each other (a Cholesky factor of 140 unknowns took 1 ms
with one thread and 90 ms with two).  So a solve runs with one BLAS thread, and large dense factorisations ask for all.

The other core is used by pieces of work that are large: while one piece is added to the matrix, the formulas of the
next are evaluated (:func:`ahead`; NumPy lets go of the interpreter's lock).  The order of the sums stays what it is.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import AbstractContextManager, nullcontext
from functools import cache, wraps
from itertools import chain, islice
from typing import Any, ParamSpec, TypeVar

from rfm.geometry.sampled import default_threads

P = ParamSpec("P")
R = TypeVar("R")
Item = TypeVar("Item")

LARGE = 1500
"""Order of a dense matrix from which on all threads pay."""


@cache
def _controller() -> Any:
    # loaded first, because SciPy brings a BLAS of its own and the controller knows only what is loaded
    import scipy.linalg  # noqa: F401
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController()


@cache
def _available() -> int:
    return max((library.num_threads for library in _controller().lib_controllers), default=1)


def one_thread() -> AbstractContextManager[Any]:
    """Context in which the BLAS uses one thread."""
    if _available() == 1:
        return nullcontext()
    context: AbstractContextManager[Any] = _controller().limit(limits=1)
    return context


def on_one_thread(function: Callable[P, R]) -> Callable[P, R]:
    """Make a function run with one BLAS thread."""

    @wraps(function)
    def limited(*args: P.args, **kwargs: P.kwargs) -> R:
        with one_thread():
            return function(*args, **kwargs)

    return limited


def threads_for(order: int) -> AbstractContextManager[Any]:
    """Context for a dense factorisation of a matrix of the given order."""
    if _available() == 1 or order < LARGE:
        return nullcontext()
    context: AbstractContextManager[Any] = _controller().limit(limits=_available())
    return context


def ahead(function: Callable[[Item], R], items: Iterable[Item]) -> Iterator[tuple[Item, R]]:
    """Yield each item with the value of a function, whose next value is computed in another thread meanwhile.

    A single item, or a process that may use one core only, needs no other thread.
    """
    iterator = iter(items)
    first = list(islice(iterator, 2))
    remaining = chain(first, iterator)
    if len(first) < 2 or default_threads() == 1:
        for item in remaining:
            yield item, function(item)
        return
    with ThreadPoolExecutor(1) as pool:
        item = next(remaining)
        value = pool.submit(function, item)
        for following in remaining:
            done, value = value.result(), pool.submit(function, following)
            yield item, done
            item = following
        yield item, value.result()
