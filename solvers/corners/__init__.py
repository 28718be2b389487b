"""Singular functions at corners: which, where, their space, its assembly, its quadrature."""
