"""Tracing: a JAX function is traced to a jaxpr, and the jaxpr becomes a straight-line program."""
