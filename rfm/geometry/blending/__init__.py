"""Blends, offsets and shells; see docs/blending.md."""

from rfm.geometry.blending.displacement import bounded_blend, displacement_blend
from rfm.geometry.blending.offset import offset, shell
from rfm.geometry.blending.rho import blend

__all__ = ["blend", "bounded_blend", "displacement_blend", "offset", "shell"]
