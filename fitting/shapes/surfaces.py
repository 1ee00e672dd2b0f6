"""Surfaces: polynomials of two variables with all monomials up to a total degree."""

import functools

import jax.numpy as jnp
import numpy as np
from jax import Array

from fitting.shapes.monomial_sums import sum_text


def surface_values(coefficients, count: int, degree: int, x, y) -> list[Array]:
    """Return the values of `count` surfaces at x and y.

    `coefficients` is flat: those of the first surface, then those of the second, and so on.
    """
    powers = _powers(degree)
    size = len(powers)
    return [
        functools.reduce(
            jnp.add,
            [
                coefficients[k * size + n] * x**i * y**j
                if i + j
                else jnp.asarray(coefficients[k * size])
                for n, (i, j) in enumerate(powers)
            ],
        )
        for k in range(count)
    ]


def surface_names(surfaces: list[str], degree: int, x: str, y: str) -> list[str]:
    """Name each coefficient of surfaces by its surface and monomial, such as 'u0: α^1 y^2'."""
    return [f"{name}: {x}^{i} {y}^{j}" for name in surfaces for i, j in _powers(degree)]


def surface_text(degree: int, x: str, y: str, first: str) -> str:
    """Write a surface as text: a sum of the coefficients C[first], C[first+1], … times monomials.

    `first` is the name of a number, or empty: the coefficients then begin at C[0].
    """
    places = [
        f"{first}+{n}" if first and n else first or str(n) for n in range(len(_powers(degree)))
    ]
    terms = {each: f"C[{place}]" for each, place in zip(_powers(degree), places, strict=True)}
    return sum_text(terms, (x, y))


def flat_start(
    values: list[float], degree: int, slopes: dict[int, tuple[float, float]] | None = None
) -> np.ndarray:
    """Return the flat coefficients of surfaces that have the constant `values`.

    `slopes` maps the numbers of some surfaces to their slopes in x and in y, which are added.
    Surfaces of degree 0 have no slopes.
    """
    start = np.zeros((len(values), (degree + 1) * (degree + 2) // 2))
    start[:, 0] = values
    for k, (by_x, by_y) in (slopes or {}).items() if degree else ():
        start[k, [degree + 1, 1]] = by_x, by_y
    return start.ravel()


def _powers(degree: int) -> list[tuple[int, int]]:
    return [(i, j) for i in range(degree + 1) for j in range(degree + 1 - i)]
