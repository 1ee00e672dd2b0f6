"""The total variation between two GGX distributions with the same normal, in closed form.

In the plane of slopes, GGX with the matrix S has the density 1/(π√|S| (1 + sᵀS⁻¹s)²). Some linear
map turns two such densities into those of the matrices 1 and diag(1/a, 1/b), and leaves the total
variation ½∫|p − q| as it is. So it depends on two numbers only: a ≤ b, the eigenvalues of S₂⁻¹S₁.
Let D = (ab)^(-¼), and D ≤ 1; otherwise the two densities are exchanged. Along a ray at the angle φ
with k = a cos²φ + b sin²φ, the density of the matrix 1 is the larger one beyond one distance if
k > 1/D, and nowhere otherwise. The integral along the ray is 1 − 1/(kD²) + (1 − D)²/(D²(k − 1)),
and its integral over φ consists of arctangents.
"""

import numpy as np
from jaxtyping import Float

Entries = Float[np.ndarray, "*texels 3"]


def total_variation(first: Entries, second: Entries) -> Float[np.ndarray, "*texels"]:
    """Return ½∫|p − q| of the distributions of two matrices (Sxx, Sxy, Syy), in [0, 1].

    Both matrices are positive definite; the result is NaN where one is not. The distribution is
    that of the projected area of facets, D(m) (m·n), which integrates to one.
    """
    first, second = np.asarray(first, float), np.asarray(second, float)
    (xx1, xy1, yy1), (xx2, xy2, yy2) = (np.moveaxis(each, -1, 0) for each in (first, second))
    with np.errstate(all="ignore"):
        ratio = (xx1 * yy1 - xy1 * xy1) / (xx2 * yy2 - xy2 * xy2)
        trace = (yy2 * xx1 - 2 * xy2 * xy1 + xx2 * yy1) / (xx2 * yy2 - xy2 * xy2)
        exchanged = ratio < 1
        half = np.where(exchanged, trace / ratio, trace) / 2
        product = np.where(exchanged, 1 / ratio, ratio)
        root = np.sqrt(np.maximum(half * half - product, 0.0))
        upper = half + root
        found = _of_eigenvalues(np.asarray(product / upper), np.asarray(upper))
    definite = (xx1 > 0) & (xx2 > 0) & (ratio > 0) & (xx1 * yy1 > xy1 * xy1)
    return np.where(definite, found, np.nan)


def _of_eigenvalues(lower: np.ndarray, upper: np.ndarray) -> np.ndarray:
    """Return the same from 0 < a ≤ b with ab ≥ 1."""
    level = (lower * upper) ** 0.25
    every = lower >= level
    # The cotangent of the angle φ where k = 1/D; infinite if k is larger at every angle
    cotangent2 = np.maximum((upper - level) / np.where(every, 1.0, level - lower), 0.0)
    cotangent = np.where(every, np.inf, np.sqrt(cotangent2))
    first = np.arctan(cotangent) - np.arctan(np.sqrt(lower / upper) * cotangent)
    first = np.where(every, 0.0, first)
    below, above = np.abs(lower - 1), np.maximum(upper - 1, np.finfo(float).tiny)
    argument = np.sqrt(below / above) * cotangent
    angle = np.where(lower > 1, np.arctan(argument), np.arctanh(np.minimum(argument, 1.0)))
    integral = np.where(below < 1e-14 * above, cotangent / above, angle / np.sqrt(below * above))
    beyond = (level - 1) ** 2 * integral
    return np.asarray(2 / np.pi * (first + np.where(level - 1 < 1e-13, 0.0, beyond)))
