"""Quadrature on domains given by Boolean expressions of smooth functions."""

from solvers.quadrature.batch import PointBatch, PointRule, TensorBatch
from solvers.quadrature.domain import DomainRules, domain_rules

__all__ = ["DomainRules", "PointBatch", "PointRule", "TensorBatch", "domain_rules"]
