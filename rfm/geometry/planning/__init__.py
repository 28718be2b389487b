"""Planning and packing: constraints as one inequality, the monotone search for an optimum, moving shapes."""

from rfm.geometry.planning.bounds import Bound, upper_bound
from rfm.geometry.planning.motion import Clash, Motion, clearance, first_contact, moving
from rfm.geometry.planning.search import Optimum, monotone_search, region

__all__ = [
    "Bound",
    "Clash",
    "Motion",
    "Optimum",
    "clearance",
    "first_contact",
    "monotone_search",
    "moving",
    "region",
    "upper_bound",
]
