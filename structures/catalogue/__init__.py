"""The catalogue of solution structures: one file for every kind of boundary condition."""
