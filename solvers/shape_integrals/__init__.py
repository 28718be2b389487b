"""Integrals of a shape, volume, surface, centroid, inertia, and their derivatives with respect to its parameters."""
