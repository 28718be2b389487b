"""Bases for the unknown psi of a solution structure, behind one interface (:mod:`solvers.bases.basis`)."""
