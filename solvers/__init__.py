"""Solvers: grids, quadrature, bases, assembly, linear algebra, and the methods that choose psi."""
