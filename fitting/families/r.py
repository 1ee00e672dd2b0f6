"""Forms of R: rational in one variable of α and in cos²θf, for t and −t are one fibre."""

import functools
from dataclasses import replace
from typing import ClassVar

import jax.numpy as jnp
import numpy as np
from jax import Array

from fitting.form import Form
from integrals import R
from shading.types import Scalar

Exponents = tuple[tuple[int, int], ...]

VARIABLES = {
    "1-alpha": ("1 − α", lambda alpha: 1 - alpha),
    "1-alpha^2": ("1 − α²", lambda alpha: 1 - alpha * alpha),
    "(1-alpha)/(1+alpha)": ("(1 − α)/(1 + α)", lambda alpha: (1 - alpha) / (1 + alpha)),
}


@functools.cache
def monomial_r(
    *, variable: str, numerator: Exponents, denominator: Exponents, least_alpha: float
) -> type[Form]:
    """Give R̃ = ½ + z N(z, y)/D(z, y), y = cos²θf, for α ≥ `least_alpha`.

    `numerator` and `denominator` hold the exponents (i, j) of the monomials zⁱyʲ with a
    coefficient; D has 1 besides. R = ½ at α = 1 is exact.
    """
    symbol, z_of = VARIABLES[variable]

    class MonomialR(Form):
        """R̃ of one set of monomials; `coefficients`: the numerator's, then the denominator's."""

        name = "monomial-r"
        equation = (
            f"R = 1/2 + z N/D, z = {symbol}, y = cos²θf, "
            f"{len(numerator)} and 1 + {len(denominator)} monomials z^i y^j"
        )
        integral = R
        axes = (replace(R.axes[0], lower=least_alpha, open_below=False), R.axes[1])
        shape: ClassVar = {
            "variable": variable,
            "numerator": [list(each) for each in numerator],
            "denominator": [list(each) for each in denominator],
            "least_alpha": least_alpha,
        }

        def __call__(self, alpha: Scalar, theta_f: Scalar) -> Array:
            """Evaluate R̃ at one material."""
            z, cosine = z_of(jnp.asarray(alpha)), jnp.cos(theta_f)
            above = zip(numerator, self.coefficients[: len(numerator)], strict=True)
            return 0.5 + z * _horner(dict(above), z, cosine * cosine) / self.positive(
                alpha, theta_f
            )

        def positive(self, alpha: Scalar, theta_f: Scalar) -> Array:
            """Give the denominator D."""
            z, cosine = z_of(jnp.asarray(alpha)), jnp.cos(theta_f)
            below = zip(denominator, self.coefficients[len(numerator) :], strict=True)
            return _horner({(0, 0): 1.0, **dict(below)}, z, cosine * cosine)

        @classmethod
        def coefficient_names(cls) -> list:
            """Name the coefficients by the monomial that each multiplies."""
            sets = {"N": numerator, "D": denominator}
            return [f"{part}: z^{i} y^{j}" for part, both in sets.items() for i, j in both]

        @classmethod
        def linear_parts(cls, alpha: Scalar, theta_f: Scalar) -> tuple[Array, Array, Array, Array]:
            """Give a₀, a, b₀, b with R̃ = (a₀ + a·c)/(b₀ + b·c) at one point."""
            z, y = z_of(jnp.asarray(alpha)), jnp.cos(theta_f) ** 2
            above = jnp.array([z ** (i + 1) * y**j for i, j in numerator])
            below = jnp.array([z**i * y**j for i, j in denominator])
            half, one = jnp.asarray(0.5), jnp.asarray(1.0)
            under = jnp.concatenate([jnp.zeros(len(numerator)), below])
            return half, jnp.concatenate([above, 0.5 * below]), one, under

        @classmethod
        def starts(cls) -> list[np.ndarray]:
            """Give none: the form is rational, and starts from a linear problem."""
            return []

    return MonomialR


def _horner(coefficients: dict, z: Array, y: Array):
    """Sum cᵢⱼ zⁱ yʲ by Horner's rule in z, of sums by Horner's rule in y."""
    total = None
    for i in range(max(i for i, _ in coefficients), -1, -1):
        row = {j: c for (k, j), c in coefficients.items() if k == i}
        inner = None
        for j in range(max(row, default=-1), -1, -1):
            inner = _plus(None if inner is None else y * inner, row.get(j))
        total = _plus(None if total is None else z * total, inner)
    return total


def _plus(one, other):
    if one is None or other is None:
        return other if one is None else one
    return other + one
