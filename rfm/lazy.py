"""Names that are imported on first use, so that a command loads only what it needs."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from importlib import import_module
from pkgutil import resolve_name
from typing import Any, TypeVar

T = TypeVar("T")


def attributes(package: str, names: Mapping[str, Sequence[str]]) -> Callable[[str], Any]:
    """Return the ``__getattr__`` of a package whose public names are in `names`, by module.

    A name that is that of a submodule too must be imported by the package itself: the import of the submodule would
    shadow it.
    """
    places = {name: module for module, several in names.items() for name in several}

    def get(name: str) -> Any:
        if name not in places:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        return getattr(import_module(places[name]), name)

    return get


class Registry(Mapping[str, T]):
    """Values by name, each in a place ``module:name`` that is imported on first use.

    Parameters
    ----------
    places
        Place of each name.
    made
        Makes the value of what is found there, such as an object of a class.
    """

    def __init__(self, places: Mapping[str, str], made: Callable[[Any], T] = lambda found: found) -> None:
        self._places, self._made = dict(places), made
        self._values: dict[str, T] = {}

    def __getitem__(self, name: str) -> T:
        """Value of that name.

        Raises
        ------
        KeyError
            There is none.
        """
        if name not in self._values:
            self._values[name] = self._made(resolve_name(self._places[name]))
        return self._values[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._places)

    def __len__(self) -> int:
        return len(self._places)
