"""The sum of a polynomial and simple poles in one variable."""

import functools

import jax.numpy as jnp
import numpy as np
from jax import Array


def poles_value(coefficients, terms: int, poles: int, x: Array) -> Array:
    """Return Σ cₖxᵏ + Σ aₖ/(bₖ + x).

    `coefficients` holds the `terms` coefficients cₖ, then aₖ and bₖ of each of the `poles`.
    """
    c = coefficients
    parts = [c[terms + 2 * k] / (c[terms + 2 * k + 1] + x) for k in range(poles)]
    if terms:
        total = c[terms - 1]
        for k in range(terms - 2, -1, -1):
            total = c[k] + x * total
        parts.insert(0, total)
    return functools.reduce(jnp.add, map(jnp.asarray, parts))


def quotient_of_poles(coefficients, terms: int, poles: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the same function as a quotient: the coefficients of both polynomials in x.

    Those of the numerator and of the denominator (`poles` + 1,) are in rising powers. The last one
    of the denominator is 1.
    """
    c = np.asarray(coefficients, float)
    factors = [np.array([b, 1.0]) for b in c[terms + 1 :: 2]]

    def product(some) -> np.ndarray:
        return functools.reduce(np.convolve, some, np.ones(1))

    below = product(factors)
    above = np.zeros(terms + poles)
    if terms:
        above += np.convolve(c[:terms], below)
    for k in range(poles):
        rest = product(factors[:k] + factors[k + 1 :])
        above[: len(rest)] += c[terms + 2 * k] * rest
    return above, below


def among_poles(
    own: tuple[int, int], most: tuple[int, int]
) -> tuple[tuple[int, ...], tuple[float, ...]]:
    """Return where the coefficients of a sum are among those of one with more terms and poles.

    Both sums are given by their `terms` and `poles`. The second result has the coefficients of the
    larger sum that make it the smaller one: zero, and one for the offset bₖ of a pole.
    """
    (terms, poles), (most_terms, most_poles) = own, most
    of_poles = range(most_terms, most_terms + 2 * poles)
    return (*range(terms), *of_poles), (0.0,) * most_terms + (0.0, 1.0) * most_poles


def least_offset(coefficients, terms: int, poles: int) -> Array:
    """Return the least of all bₖ and 1. If it is positive, no pole x = −bₖ is at x ≥ 0."""
    offsets = [coefficients[terms + 2 * k + 1] for k in range(poles)]
    return functools.reduce(jnp.minimum, offsets, jnp.ones(()))


def pole_names(terms: int, poles: int) -> list[str]:
    """Name the coefficients: 'c1: x' by the power that it multiplies, 'a1' and 'b1' by the pole."""
    inner = ["1", *(f"x{_superscript(k)}" for k in range(1, terms))][:terms]
    numbered = [f"c{k}: {name}" for k, name in enumerate(inner)]
    return numbered + [f"{letter}{k + 1}" for k in range(poles) for letter in "ab"]


def poles_text(terms: int, poles: int, x: str) -> str:
    """Write the sum as text, such as 'c0 + c1·x + a1/(b1 + x)'."""
    powers = {
        k: x if k == 1 else f"{f'({x})' if len(x) > 1 else x}{_superscript(k)}"
        for k in range(terms)
    }
    parts = ["c0", *(f"c{k}·{powers[k]}" for k in range(1, terms))][:terms]
    return " + ".join([*parts, *(f"a{k}/(b{k} + {x})" for k in range(1, poles + 1))])


def pole_starts(terms: int, poles: int) -> tuple[np.ndarray, ...]:
    """Return starts (coefficients,) of a fit: a polynomial of zero, poles at several distances.

    The distances are those from x = 0. Without poles there is one start, zero.
    """
    distances = ([0.9, 0.1, 0.01, 0.001], [0.5, 0.2, 0.05, 0.02], [3.0, 0.8, 0.2, 0.05])
    starts = [
        np.concatenate([np.zeros(terms), *([0.0, b] for b in each[:poles])]) for each in distances
    ]
    return tuple(starts if poles else starts[:1])


def _superscript(k: int) -> str:
    return "" if k == 1 else "⁰¹²³⁴⁵⁶⁷⁸⁹"[k]
