"""Quadrature rules for standard domains: intervals (`interval`) and the hemisphere (`hemisphere`).

A rule is a pair of NumPy arrays, nodes and weights. JAX treats them as constants under `jit`.
"""
