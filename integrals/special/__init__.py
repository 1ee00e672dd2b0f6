"""Special functions that the closed forms need and that JAX lacks."""
