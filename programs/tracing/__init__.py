"""From a JAX function to a straight-line program, by way of its jaxpr."""
