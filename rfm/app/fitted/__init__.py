"""Meshes fitted to the boundary of a shape, for files and pictures only: nothing is computed on them."""

from rfm.app.fitted.mesh import FittedMesh, fit

__all__ = ["FittedMesh", "fit"]
