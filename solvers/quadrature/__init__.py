"""Quadrature on domains given by Boolean expressions of smooth functions."""

from solvers.quadrature.batch import PointBatch, TensorBatch
from solvers.quadrature.domain import DomainRules, domain_rules

__all__ = ["DomainRules", "PointBatch", "TensorBatch", "domain_rules"]
