"""Quadrature rules for standard domains: intervals (`interval`) and the hemisphere (`hemisphere`).

A rule is a pair of NumPy arrays, nodes and weights. JAX treats them as constants under `jit`.

`adaptive` integrates a function that is not known in advance over the unit cube, by products of
rules (`product`). `ranges` and `directions` map the cube to other ranges and to directions.
"""
