"""Products of Gauss–Legendre rules on the unit cube, and what the values at their nodes tell."""

import functools
import itertools

import numpy as np

from integrals.rules.interval import gauss_legendre


@functools.cache
def product_rule(nodes: int, variables: int) -> tuple[np.ndarray, np.ndarray]:
    """Return nodes (nodes^k, k) and weights (nodes^k,) of the product rule on the unit cube."""
    x, w = gauss_legendre(nodes, 0.0, 1.0)
    points = np.array(list(itertools.product(x, repeat=variables)))
    weights = functools.reduce(np.multiply.outer, [w] * variables, np.ones(1))
    return points, weights.reshape(-1)


@functools.cache
def last_coefficients(nodes: int) -> np.ndarray:
    """Return the matrix (nodes/4, nodes) from values at the nodes to the last coefficients.

    These are the coefficients of the highest Legendre polynomials in the polynomial that
    interpolates the integrand at the nodes: (2m + 1) Σ wᵢ P_m(2xᵢ − 1) f(xᵢ) on [0, 1].
    """
    x, w = gauss_legendre(nodes, 0.0, 1.0)
    degrees = np.arange(nodes - max(2, nodes // 4), nodes)
    polynomials = np.polynomial.legendre.legvander(2 * x - 1, nodes - 1)[:, degrees]
    return (2 * degrees + 1)[:, None] * (w[:, None] * polynomials).T


@functools.cache
def value_at_end(nodes: int, face: int) -> np.ndarray:
    """Return the vector (nodes,) from values at the nodes to the polynomial's value at 0 or 1."""
    x, w = gauss_legendre(nodes, 0.0, 1.0)
    degrees = np.arange(nodes)
    coefficients = (2 * degrees + 1)[:, None] * (
        w[:, None] * np.polynomial.legendre.legvander(2 * x - 1, nodes - 1)
    ).T
    return (1.0 if face else -1.0) ** degrees @ coefficients
