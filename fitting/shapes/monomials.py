"""Polynomials of two variables that have only some of the monomials zⁱyʲ, by Horner's rule."""

from collections.abc import Mapping
from typing import Any

# The exponents (i, j) of monomials zⁱyʲ.
Exponents = tuple[tuple[int, int], ...]


def horner(coefficients: Mapping[tuple[int, int], Any], z: Any, y: Any) -> Any:
    """Return Σ cᵢⱼ zⁱ yʲ for `coefficients` that map (i, j) to cᵢⱼ.

    Horner's rule is applied to z. Each power of z has a polynomial in y as its coefficient, to
    which the rule is applied too.
    """
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
