"""Functions of pieces of boundary: segments, arcs, curves, faces and points, one by one and joined.

Every function is a field that is zero exactly on the pieces, positive elsewhere and of unit slope across them; for
closed curves and surfaces there is also a signed one, positive inside.  See docs/boundary-functions.md.
"""

from rfm.geometry.boundaries.arcs import arc, arc_about, arc_through, circle
from rfm.geometry.boundaries.beziers import bezier, spline
from rfm.geometry.boundaries.mixed import MixedSet, mixed_set
from rfm.geometry.boundaries.pieces import Joined, Pieces
from rfm.geometry.boundaries.points import points
from rfm.geometry.boundaries.segments import polyline, segment
from rfm.geometry.boundaries.signed import Signed, signed
from rfm.geometry.boundaries.solid_angle import signed_surface
from rfm.geometry.boundaries.surface_files import read_surface
from rfm.geometry.boundaries.triangles import surface, triangle

__all__ = [
    "Joined",
    "MixedSet",
    "Pieces",
    "Signed",
    "arc",
    "arc_about",
    "arc_through",
    "bezier",
    "circle",
    "mixed_set",
    "points",
    "polyline",
    "read_surface",
    "segment",
    "signed",
    "signed_surface",
    "spline",
    "surface",
    "triangle",
]
