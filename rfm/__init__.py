"""rfm: boundary value problems on shapes written as formulas, without a mesh.

``rfm.solve(case)`` runs a case file, ``rfm.load(file)`` reads a finished run.  The packages beneath are
``rfm.calculus`` (jets, intervals, R-functions), ``rfm.geometry`` (shapes), ``structures`` (solution
structures) and ``solvers`` (grids, quadrature, splines, Ritz).
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

__version__ = "0.1.0"

_LAZY = {
    "solve": ("rfm.app.api", "solve"),
    "load": ("rfm.app.api", "load"),
    "Run": ("rfm.app.api", "Run"),
    "RfmError": ("rfm.errors", "RfmError"),
}

__all__ = ["RfmError", "Run", "__version__", "load", "solve"]


def __getattr__(name: str) -> Any:
    """Import the public names on first use, so that ``import rfm`` stays light."""
    try:
        module, attribute = _LAZY[name]
    except KeyError:
        raise AttributeError(f"module 'rfm' has no attribute {name!r}") from None
    return getattr(import_module(module), attribute)


def __dir__() -> list[str]:
    return sorted(__all__)
