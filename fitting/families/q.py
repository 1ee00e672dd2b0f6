"""Forms of Q in one variable: a polynomial and poles, inside what is known of Q at d = 0.

Q = 1 − 2d − d² ln d + O(d²): near d = 0 neither polynomials nor rational functions of d follow it.
"""

import functools
from dataclasses import replace
from typing import ClassVar

import jax.numpy as jnp
import numpy as np
from jax import Array

from fitting.form import Form
from integrals import Q
from shading.types import Scalar

AXES = (replace(Q.axes[0], upper=0.5),)
# ln d is taken of at least this; its factor d² is far below rounding there.
LEAST_DENSITY = 1e-30

# What surrounds the polynomial and the poles r, and the variable that they are of.
STRUCTURES = {
    "free": "r(d)",
    "one": "1 + d r(d)",
    "slope": "1 + d (d r(√d) − 2)",
    "log": "1 + d (d (r(d) − ln d) − 2)",
}


def _surround(structure: str, d: Array, r) -> Array:
    if structure == "free":
        return r(d)
    if structure == "one":
        return 1 + d * r(d)
    if structure == "slope":
        return 1 + d * (d * r(jnp.sqrt(d)) - 2)
    return 1 + d * (d * (r(d) - jnp.log(jnp.maximum(d, LEAST_DENSITY))) - 2)


@functools.cache
def pole_q(*, structure: str, terms: int, poles: int) -> type[Form]:
    """Give the form of Q with a polynomial of `terms` and as many `poles` aₖ/(bₖ + x)."""
    inner = [("", f" x{_superscript(k)}")[k > 0] for k in range(terms)]
    pole_names = [f"{letter}{k + 1}" for k in range(poles) for letter in "ab"]

    class PoleQ(Form):
        """Q̃ of one structure; `coefficients`: the polynomial's, then a, b of each pole."""

        name = "pole-q"
        equation = f"Q = {STRUCTURES[structure]}, r a polynomial of {terms} terms and {poles} poles"
        integral = Q
        axes = AXES
        shape: ClassVar = {"structure": structure, "terms": terms, "poles": poles}

        def __call__(self, density: Scalar) -> Array:
            """Evaluate Q̃ at one density."""
            c = self.coefficients

            def r(x: Array) -> Array:
                parts = [c[terms + 2 * k] / (c[terms + 2 * k + 1] + x) for k in range(poles)]
                if terms:
                    total = c[terms - 1]
                    for k in range(terms - 2, -1, -1):
                        total = c[k] + x * total
                    parts.insert(0, total)
                return functools.reduce(jnp.add, map(jnp.asarray, parts))

            return _surround(structure, jnp.asarray(density), r)

        def positive(self, density: Scalar) -> Array:
            """Give the least distance of a pole from the domain."""
            offsets = [self.coefficients[terms + 2 * k + 1] for k in range(poles)]
            return functools.reduce(jnp.minimum, offsets, jnp.ones(()))

        @classmethod
        def coefficient_names(cls) -> list:
            """Name the coefficients by what they multiply, or by the pole that they belong to."""
            return [f"c{k}:{name or ' 1'}" for k, name in enumerate(inner)] + pole_names

        @classmethod
        def starts(cls) -> list[np.ndarray]:
            """Give starts: no polynomial, and poles at several distances from the domain."""
            distances = ([0.9, 0.1, 0.01, 0.001], [0.5, 0.2, 0.05, 0.02], [3.0, 0.8, 0.2, 0.05])
            return [
                np.concatenate([np.zeros(terms), *([0.0, b] for b in each[:poles])])
                for each in distances
            ][: None if poles else 1]

    return PoleQ


def _superscript(k: int) -> str:
    return "" if k == 1 else "⁰¹²³⁴⁵⁶⁷⁸⁹"[k]
