"""What the quadrature tests measure: volume, boundary measure and the two integrals of the divergence theorem."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rfm.calculus.types import Array
from rfm.geometry.shape import Shape
from solvers.classify import classify
from solvers.grid import Grid
from solvers.quadrature import DomainRules, domain_rules


@dataclass(frozen=True)
class Measured:
    grid: Grid
    rules: DomainRules

    @property
    def volume(self) -> float:
        return float(self.rules.inner.weights.sum() + self.rules.cut.weights.sum())

    @property
    def perimeter(self) -> float:
        return float(sum(batch.weights.sum() for batch in self.rules.boundary.values()))

    @property
    def flux_of_constants(self) -> float:
        """Largest component of the integral of the normal: 0 over a closed boundary."""
        total = np.zeros(self.grid.dimension)
        for batch in self.rules.boundary.values():
            total += np.einsum("nq,nqd->d", batch.weights, batch.normals)
        return float(np.abs(total).max())

    @property
    def volume_by_divergence(self) -> float:
        """Integral of x.n over the boundary divided by the dimension: the volume."""
        total = 0.0
        for batch in self.rules.boundary.values():
            for j, x in enumerate(batch.points(self.grid)):
                total += float((batch.weights * batch.normals[..., j] * x).sum())
        return total / self.grid.dimension

    def integral(self, function) -> float:
        rules = self.rules
        return sum(
            float((b.weights * function(*b.points(self.grid))).sum()) for b in (rules.inner, rules.cut)
        )

    def of(self, name: str) -> float:
        """Measure of the surface with a dotted name."""
        return float(sum(b.weights.sum() for s, b in self.rules.boundary.items() if s.name == name))


def measure(domain: Shape, cells: int | Grid, points: int) -> Measured:
    grid = cells if isinstance(cells, Grid) else Grid.cover(domain.box, cells)
    return Measured(grid, domain_rules(domain, classify(domain, grid), inner=points, cut=points))


def check_rules(measured: Measured) -> None:
    """Positive weights, points in their cells, outward unit normals."""
    cut = measured.rules.cut
    assert (cut.weights > 0).all()
    assert cut.nodes.min(initial=0.0) >= 0.0
    assert cut.nodes.max(initial=1.0) <= 1.0
    assert len(np.unique(cut.cells, axis=0)) == len(cut.cells)
    for batch in measured.rules.boundary.values():
        assert batch.normals is not None
        assert (batch.weights >= 0).all()
        lengths = np.sqrt((batch.normals**2).sum(axis=-1))
        np.testing.assert_allclose(lengths, 1.0, rtol=1e-13)


def slope(sizes: Array, errors: Array) -> float:
    return float(-np.polyfit(np.log(sizes), np.log(errors), 1)[0])
