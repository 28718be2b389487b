"""Transformations of shapes, one file for each map; see docs/transforms.md."""

from rfm.geometry.transforms.affine import affine, mirror
from rfm.geometry.transforms.cyclic import cyclic
from rfm.geometry.transforms.extrude import extrude
from rfm.geometry.transforms.repeat import repeat, repeat_series
from rfm.geometry.transforms.revolve import revolve
from rfm.geometry.transforms.screw import screw, twist
from rfm.geometry.transforms.section import projection, section
from rfm.geometry.transforms.sweep import helix, sweep, sweep_along
from rfm.geometry.transforms.taper import taper

__all__ = [
    "affine",
    "cyclic",
    "extrude",
    "helix",
    "mirror",
    "projection",
    "repeat",
    "repeat_series",
    "revolve",
    "screw",
    "section",
    "sweep",
    "sweep_along",
    "taper",
    "twist",
]
