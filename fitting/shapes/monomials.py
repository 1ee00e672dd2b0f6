"""Polynomials of two variables that have only some of the monomials zⁱyʲ, by Horner's rule."""

import functools
from collections.abc import Mapping
from typing import Any

# The exponents (i, j) of monomials zⁱyʲ.
Exponents = tuple[tuple[int, int], ...]


def horner(coefficients: Mapping[tuple[int, int], Any], z: Any, y: Any) -> Any:
    """Return Σ cᵢⱼ zⁱ yʲ for `coefficients` that map (i, j) to cᵢⱼ.

    Horner's rule is applied to z. Each power of z has a polynomial in y as its coefficient, to
    which the rule is applied too.
    """
    rows = range(max(i for i, _ in coefficients) + 1)
    columns = range(max(j for _, j in coefficients) + 1)
    return _horner([_horner([coefficients.get((i, j)) for j in columns], y) for i in rows], z)


def _horner(terms: list, x: Any) -> Any:
    """Return the sum of terms times x⁰, x¹, …; a term of None is absent, and so may be the sum."""
    return functools.reduce(
        lambda higher, term: _plus(None if higher is None else x * higher, term),
        reversed(terms),
        None,
    )


def _plus(one, other):
    if one is None or other is None:
        return other if one is None else one
    return other + one
