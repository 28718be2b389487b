"""Where a shape is not smooth: corners in the plane, edges and vertices in space, and the criterion kappa."""
