"""The registry of kinds of shape that are made of other shapes, by the names of a case file.

Their first argument is ``of``: a shape, or for blends a list of shapes.  Angles are in radians here.
"""

from __future__ import annotations

from collections.abc import Callable
from types import MappingProxyType

from rfm.geometry.blending import blend, bounded_blend, displacement_blend, offset, shell
from rfm.geometry.shape import Shape
from rfm.geometry.transforms import (
    cyclic,
    extrude,
    projection,
    repeat,
    repeat_series,
    revolve,
    screw,
    section,
    sweep,
)

DERIVED: MappingProxyType[str, Callable[..., Shape]] = MappingProxyType(
    {
        "blend": blend,
        "displacement_blend": displacement_blend,
        "bounded_blend": bounded_blend,
        "offset": offset,
        "shell": shell,
        "repeat": repeat,
        "repeat_series": repeat_series,
        "cyclic": cyclic,
        "sweep": sweep,
        "extrude": extrude,
        "revolve": revolve,
        "screw": screw,
        "section": section,
        "projection": projection,
    }
)
