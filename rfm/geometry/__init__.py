"""Shapes as formulas: primitives, Boolean operations, and the four functions of a boundary.

``membership`` (sign), ``weight`` (smooth, zero exactly on a part), ``distance`` (normalised) and
``extend`` (boundary data carried inward); see docs/geometry.md.
"""

from typing import TYPE_CHECKING

from rfm.geometry.distance import distance
from rfm.geometry.primitives_3d import box
from rfm.geometry.weight import weight
from rfm.lazy import attributes

if TYPE_CHECKING:
    from rfm.geometry.boundaries.curve import curve
    from rfm.geometry.box import Box
    from rfm.geometry.extension import extend
    from rfm.geometry.normalisation import kept_order, normalise
    from rfm.geometry.outlines.outline import outline
    from rfm.geometry.outlines.polygon import polygon
    from rfm.geometry.outlines.polyhedron import polyhedron
    from rfm.geometry.outlines.signed import signed_difference
    from rfm.geometry.part import Part
    from rfm.geometry.primitives import KINDS, function
    from rfm.geometry.primitives_1d import interval
    from rfm.geometry.primitives_2d import disk, ellipse, half_plane, rectangle, strip
    from rfm.geometry.primitives_3d import ball, cone, cylinder, ellipsoid, half_space, slab, torus
    from rfm.geometry.sampled import sample
    from rfm.geometry.shape import Shape
    from rfm.geometry.surface import Surface
    from rfm.geometry.trimming import trimmed

__all__ = [
    "KINDS",
    "Box",
    "Part",
    "Shape",
    "Surface",
    "ball",
    "box",
    "cone",
    "curve",
    "cylinder",
    "disk",
    "distance",
    "ellipse",
    "ellipsoid",
    "extend",
    "function",
    "half_plane",
    "half_space",
    "interval",
    "kept_order",
    "normalise",
    "outline",
    "polygon",
    "polyhedron",
    "rectangle",
    "sample",
    "signed_difference",
    "slab",
    "strip",
    "torus",
    "trimmed",
    "weight",
]

__getattr__ = attributes(
    __name__,
    {
        "rfm.geometry.boundaries.curve": ("curve",),
        "rfm.geometry.box": ("Box",),
        "rfm.geometry.extension": ("extend",),
        "rfm.geometry.normalisation": (
            "kept_order",
            "normalise",
        ),
        "rfm.geometry.outlines.outline": ("outline",),
        "rfm.geometry.outlines.polygon": ("polygon",),
        "rfm.geometry.outlines.polyhedron": ("polyhedron",),
        "rfm.geometry.outlines.signed": ("signed_difference",),
        "rfm.geometry.part": ("Part",),
        "rfm.geometry.primitives": (
            "KINDS",
            "function",
        ),
        "rfm.geometry.primitives_1d": ("interval",),
        "rfm.geometry.primitives_2d": (
            "disk",
            "ellipse",
            "half_plane",
            "rectangle",
            "strip",
        ),
        "rfm.geometry.primitives_3d": (
            "ball",
            "cone",
            "cylinder",
            "ellipsoid",
            "half_space",
            "slab",
            "torus",
        ),
        "rfm.geometry.sampled": ("sample",),
        "rfm.geometry.shape": ("Shape",),
        "rfm.geometry.surface": ("Surface",),
        "rfm.geometry.trimming": ("trimmed",),
    },
)
