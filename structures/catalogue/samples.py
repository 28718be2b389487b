"""Shapes and data of the catalogue's examples: curved, not normalised by themselves, without symmetry."""

from __future__ import annotations

import rfm.geometry as g
from rfm.calculus.functions import cos, exp, sin
from rfm.calculus.types import Value

ELLIPSE = g.ellipse(center=(0.1, -0.05), semi_axes=(1.0, 0.7), angle=0.3).named("rim")
PLATE = ELLIPSE - g.disk(center=(0.2, 0.1), radius=0.25).named("hole")
RECTANGLE = g.rectangle(min=(0.0, 0.0), max=(1.5, 1.0)).named("box")
BALL = g.ellipsoid(center=(0.0, 0.1, 0.0), semi_axes=(1.0, 0.8, 0.9)).named("outer")
SHELL = BALL - g.ball(center=(0.1, 0.0, 0.1), radius=0.3).named("inner")


def first(x: Value, y: Value, z: Value = 0.0) -> Value:
    """A smooth datum."""
    return exp(0.4 * x) * sin(1.3 * y + 0.2) + x * z + 0.5


def second(x: Value, y: Value, z: Value = 0.0) -> Value:
    """Another one."""
    return cos(1.1 * x - 0.6 * y) + 0.3 * y * y - 0.2 * z


def positive(x: Value, y: Value, z: Value = 0.0) -> Value:
    """A positive one: a conductivity."""
    return 1.5 + 0.4 * sin(x + 2.0 * y - z)
