"""Quadrature on domains given by Boolean expressions of smooth functions."""

from typing import TYPE_CHECKING

from rfm.lazy import attributes

if TYPE_CHECKING:
    from solvers.quadrature.batch import PointBatch, PointRule, TensorBatch
    from solvers.quadrature.domain import DomainRules, domain_rules

__all__ = ["DomainRules", "PointBatch", "PointRule", "TensorBatch", "domain_rules"]

__getattr__ = attributes(
    __name__,
    {
        "solvers.quadrature.batch": ("PointBatch", "PointRule", "TensorBatch"),
        "solvers.quadrature.domain": ("DomainRules", "domain_rules"),
    },
)
