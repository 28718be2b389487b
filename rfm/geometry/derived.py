"""The registry of kinds of shape that are made of other shapes, by the names of a case file.

Their first argument is ``of``: a shape, or for blends a list of shapes.  Angles are in radians here.
"""

from __future__ import annotations

from collections.abc import Callable

from rfm.geometry.shape import Shape
from rfm.lazy import Registry

DERIVED: Registry[Callable[..., Shape]] = Registry(
    {
        "blend": "rfm.geometry.blending:blend",
        "displacement_blend": "rfm.geometry.blending:displacement_blend",
        "bounded_blend": "rfm.geometry.blending:bounded_blend",
        "offset": "rfm.geometry.blending:offset",
        "shell": "rfm.geometry.blending:shell",
        "repeat": "rfm.geometry.transforms:repeat",
        "repeat_series": "rfm.geometry.transforms:repeat_series",
        "cyclic": "rfm.geometry.transforms:cyclic",
        "sweep": "rfm.geometry.transforms:sweep",
        "extrude": "rfm.geometry.transforms:extrude",
        "revolve": "rfm.geometry.transforms:revolve",
        "screw": "rfm.geometry.transforms:screw",
        "section": "rfm.geometry.transforms:section",
        "projection": "rfm.geometry.transforms:projection",
    }
)
