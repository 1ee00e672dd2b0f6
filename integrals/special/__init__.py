"""Special functions that the closed forms need and JAX does not have."""
