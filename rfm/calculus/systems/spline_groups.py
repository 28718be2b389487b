"""Six groups of free ordinates for each bidegree of the spline R-functions.

Groups 1 to 3 are r = c p(x, y) + A (-|x|^k - |y|^k) with each |.|^k for negative arguments only, p = x y for k = 2 and
x y (x + y)/2 for k = 3 (p = x y for x, y > 0 only with k = 1): a simple growth inside against a steep fall outside.
They keep their signs for arguments of any size.  Groups 4 to 6 are level at the value -1 on the sides x = -1 and
y = -1, with p as above (4) or with a slope along the edges that has reached its final value at 1 (5, 6; 6 also slopes
along the sides).  They are certified in [-1, 1]^2, and need a bound for larger arguments.

| group | inside | outside |
|---|---|---|
| 1 | p, balanced | homogeneous: signs hold everywhere |
| 2 | p, steep | homogeneous, gentle |
| 3 | p, gentle | homogeneous, steep |
| 4 | p | level |
| 5 | flat | level |
| 6 | flat | sloped |

All ordinates lie in [-1, 1], and hence all values: iterated operations stay in the range.
"""

from __future__ import annotations

from types import MappingProxyType

from rfm.calculus.systems.spline import DEGREES, RSpline
from rfm.errors import GeometryError

_Ordinates = tuple[tuple[float, ...], tuple[float, ...], float]

GROUPS: MappingProxyType[int, tuple[_Ordinates, ...]] = MappingProxyType(
    {
        1: (
            ((0.5,), (-0.5, -0.5), -1.0),
            ((1.0,), (-0.25, -0.25), -0.5),
            ((0.25,), (-0.5, -0.5), -1.0),
            ((0.5,), (-1.0, -1.0), -1.0),
            ((1.0,), (-1.0, -1.0), -1.0),
            ((1.0,), (-0.5, -1.0), -1.0),
        ),
        2: (
            ((0.125, 0.25, 0.5), (-0.5, -0.75, -1.0), -0.5),
            ((0.15, 0.3, 0.6), (-0.4, -0.7, -1.0), -0.2),
            ((0.05, 0.1, 0.2), (-0.6, -0.7, -0.8), -1.0),
            ((0.25, 0.5, 1.0), (-1.0, -1.0, -1.0), -1.0),
            ((0.4, 0.4, 0.4), (-1.0, -1.0, -1.0), -1.0),
            ((0.3, 0.3, 0.3), (-0.7, -0.9, -1.0), -1.0),
        ),
        3: (
            ((0.0, 0.02, 0.06, 0.08, 0.18, 0.36), (-0.32, -0.26, -0.26, -0.32), -1.0),
            ((0.0, 0.04, 0.12, 0.16, 0.36, 0.72), (-0.14, -0.02, -0.02, -0.14), -1.0),
            ((0.0, 0.01, 0.03, 0.04, 0.09, 0.18), (-0.41, -0.38, -0.38, -0.41), -1.0),
            ((0.0, 0.05, 0.15, 0.2, 0.45, 0.9), (-1.0, -1.0, -1.0, -1.0), -1.0),
            ((0.0, 0.1, 0.1, 0.4, 0.5, 0.6), (-1.0, -1.0, -1.0, -1.0), -1.0),
            ((0.0, 0.1, 0.1, 0.4, 0.5, 0.6), (-0.6, -0.7, -0.8, -1.0), -1.0),
        ),
    }
)
"""Inner, outer and corner ordinates by bidegree; group 1 is the first."""

SCALE_FREE = 3
"""Groups up to this keep their signs for arguments of any size."""


def spline_system(degree: int, group: int = 1, bound: float = 1.0) -> RSpline:
    """Return the spline R-functions of a bidegree with a group of ordinates.

    Parameters
    ----------
    degree
        Bidegree, 1 to 3.
    group
        1 to 6.
    bound
        Size of the arguments.

    Raises
    ------
    GeometryError
        There is no such bidegree or group, or the bound is not positive.
    """
    if degree not in DEGREES:
        raise GeometryError(f"spline R-functions have bidegree 1, 2 or 3, got {degree}")
    if not 1 <= group <= len(GROUPS[degree]):
        raise GeometryError(f"spline R-functions have groups 1 to {len(GROUPS[degree])}, got {group}")
    return RSpline(degree, *GROUPS[degree][group - 1], bound)
