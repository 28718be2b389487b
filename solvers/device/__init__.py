"""The matrix of an energy, never assembled, on whatever JAX computes on."""
