"""Polynomials of a total degree in two variables, several at a time."""

import functools

import jax.numpy as jnp
import numpy as np
from jax import Array


def surface_values(coefficients, count: int, degree: int, x, y) -> list[Array]:
    """Return `count` polynomials of a total degree in x and y, their coefficients in a row."""
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
    """Name the coefficients of surfaces by surface and monomial of the variables' symbols."""
    return [f"{name}: {x}^{i} {y}^{j}" for name in surfaces for i, j in _powers(degree)]


def flat_start(
    values: list[float], degree: int, slopes: dict[int, tuple[float, float]] | None = None
) -> np.ndarray:
    """Return coefficients of constant surfaces; `slopes` gives some of them slopes by x and y.

    Surfaces of degree 0 have no slopes.
    """
    start = np.zeros((len(values), (degree + 1) * (degree + 2) // 2))
    start[:, 0] = values
    for k, (by_x, by_y) in (slopes or {}).items() if degree else ():
        start[k, [degree + 1, 1]] = by_x, by_y
    return start.ravel()


def _powers(degree: int) -> list[tuple[int, int]]:
    return [(i, j) for i in range(degree + 1) for j in range(degree + 1 - i)]
