"""rfm: boundary value problems on shapes written as formulas, without a mesh.

``rfm.solve(case)`` runs a case file, ``rfm.load(file)`` reads a finished run.  The packages beneath are
``rfm.calculus`` (jets, intervals, R-functions), ``rfm.geometry`` (shapes), ``structures`` (solution
structures) and ``solvers`` (grids, quadrature, splines, Ritz).
"""

from __future__ import annotations

from rfm.lazy import attributes

__version__ = "0.1.0"

__all__ = ["RfmError", "Run", "__version__", "load", "solve"]


__getattr__ = attributes(__name__, {"rfm.app.api": ("solve", "load", "Run"), "rfm.errors": ("RfmError",)})


def __dir__() -> list[str]:
    return sorted(__all__)
