"""What the catalogue says about a structure, and how it proves it.

An entry states its formula and what it satisfies; its examples are structures on real shapes together with
the conditions they claim.  :meth:`Example.residual` takes random functions psi and measures the conditions at
random boundary points, with normals and curvatures of the *surfaces*, not of the w in the structure.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from rfm.calculus.functions import cos, exp
from rfm.calculus.jets import partials
from rfm.calculus.types import Array, Value
from rfm.geometry.part import Part
from rfm.geometry.shape import Shape
from structures.catalogue.traces import BoundaryJets, Trace, boundary_frame
from structures.contact import boundary_points, finite_box
from structures.jet_matrix import evaluate_all
from structures.operator import Operator

COUNT = 1000


@dataclass(frozen=True)
class Entry:
    """One structure of the catalogue.

    Attributes
    ----------
    name
        How users find it.
    satisfies
        The conditions, in words.
    formula
        As in the paper, on one line.
    conditions
        Names of the conditions it carries.
    unknowns
        Number of psi's for each component of u.
    normalisation
        Order to which w must be normalised; 0: any smooth weight will do.
    derivatives
        Highest derivative of a psi in it.
    examples
        Structures with the conditions they claim.
    """

    name: str
    satisfies: str
    formula: str
    conditions: tuple[str, ...]
    unknowns: int
    normalisation: int
    derivatives: int
    examples: Callable[[], Sequence[Example]]


class Example(ABC):
    """A structure on a shape whose conditions can be measured.

    Attributes
    ----------
    operators
        The components of u.
    """

    operators: Sequence[Operator]

    @abstractmethod
    def residual(self, seed: int, count: int = COUNT) -> dict[str, float]:
        """Measure every condition for random psi at ``count`` random boundary points.

        Returns
        -------
        dict
            Largest residual of each condition, relative to the derivatives of u in it.
        """


@dataclass(frozen=True, eq=False)
class OnBoundary(Example):
    """Conditions on parts of the boundary of a shape.

    Attributes
    ----------
    domain
        The shape.
    operators
        Components of u.
    checks
        Parts and what holds on them.
    """

    domain: Shape
    operators: Sequence[Operator]
    checks: Sequence[tuple[Part, Trace]]

    def residual(self, seed: int, count: int = COUNT) -> dict[str, float]:
        """See :meth:`Example.residual`."""
        rng = np.random.default_rng(seed)
        psi = random_fields(self.operators, rng)
        found: dict[str, float] = {}
        for part, trace in self.checks:
            points = random_points(self.domain, part, rng, count)
            normal, curvature = boundary_frame(self.domain, part, points)
            jets = BoundaryJets(points, normal, curvature, jets_of(self.operators, psi, points, trace.order))
            key = f"{part.name}: {trace.name}"
            found[key] = max(found.get(key, 0.0), trace.relative(jets))
        return found


@dataclass(frozen=True)
class RandomField:
    """A smooth function with many scales: sum of a_k exp(b_k . x) cos(c_k . x + e_k)."""

    amplitude: Array
    growth: Array
    wave: Array
    phase: Array

    def __call__(self, *coords: Value) -> Value:
        """Evaluate at coordinates of any kind."""
        total: Value = 0.0
        for a, b, c, e in zip(self.amplitude, self.growth, self.wave, self.phase, strict=True):
            slope = sum(float(g) * x for g, x in zip(b, coords, strict=True))
            angle = sum(float(k) * x for k, x in zip(c, coords, strict=True))
            total = total + float(a) * exp(slope) * cos(angle + float(e))
        return total


def random_field(dimension: int, rng: np.random.Generator, terms: int = 3) -> RandomField:
    """Draw a smooth function."""
    return RandomField(
        rng.normal(size=terms),
        rng.normal(size=(terms, dimension)),
        2.0 * rng.normal(size=(terms, dimension)),
        rng.uniform(0, 6, terms),
    )


def random_fields(operators: Sequence[Operator], rng: np.random.Generator) -> dict[int, RandomField]:
    """Draw one function for every psi."""
    indices = sorted({m for op in operators for m in op.unknowns})
    return {m: random_field(operators[0].dimension, rng) for m in indices}


def random_points(domain: Shape, part: Part, rng: np.random.Generator, count: int) -> Array:
    """Return ``(d, count)`` random points on a part of the boundary of a shape."""
    box = finite_box(domain.box)
    lower, upper = np.array(box.lower), np.array(box.upper)
    margin = 0.05 * (upper - lower)
    found = np.empty((0, domain.dimension))
    for _ in range(20):
        seeds = rng.uniform(lower - margin, upper + margin, (2 * count, domain.dimension))
        found = np.concatenate([found, boundary_points(domain, part, seeds)])
        if len(found) >= count:
            break
    return np.asarray(rng.permutation(found)[:count].T)


def jets_of(operators: Sequence[Operator], psi: dict[int, RandomField], points: Array, order: int) -> Array:
    """Return the partial derivatives ``(components, n_beta, n)`` of u for given psi."""
    matrices = evaluate_all(operators, tuple(points), order)
    total = order + max(op.order for op in operators)
    tables = {m: partials(f, tuple(points), total) for m, f in psi.items()}
    return np.stack([matrix.apply(tables) for matrix in matrices])
