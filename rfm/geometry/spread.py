"""Points spread evenly, the same ones every time.

A Kronecker sequence with the generalised golden ratio, the root of r^(d+1) = r + 1 (Roberts 2018).
"""

from __future__ import annotations

import numpy as np

from rfm.calculus.types import Array


def spread(count: int, dimension: int) -> Array:
    """Return points ``(count, dimension)`` of the unit cube."""
    ratio = 1.5
    for _ in range(32):
        ratio = (1 + ratio) ** (1 / (dimension + 1))
    steps = ratio ** -np.arange(1.0, dimension + 1)
    return np.asarray((0.5 + np.outer(np.arange(1, count + 1), steps)) % 1.0)
