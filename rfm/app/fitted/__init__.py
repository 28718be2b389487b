"""Meshes fitted to the boundary of a shape, for files and pictures only: nothing is computed on them."""

from rfm.app.fitted.mesh import EdgeCells, FittedMesh, fit

__all__ = ["EdgeCells", "FittedMesh", "fit"]
