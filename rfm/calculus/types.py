"""The types that every room of the package shares.

Array
    A NumPy array of double precision numbers.
Value
    What a field is evaluated on and returns: a number, an array, a `Jet`, an `Interval` or a JAX array.
Field
    A function of the coordinates, called as ``f(x, y)`` or ``f(x, y, z)`` with values of one kind. It
    broadcasts, and may return a plain number where it is constant.
"""

from collections.abc import Callable
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[np.float64]
Value: TypeAlias = Any
Field: TypeAlias = Callable[..., Value]
