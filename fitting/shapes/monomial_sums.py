"""Sums of monomials in any number of variables: exponents, names, texts, and nested Horner form."""

import functools
import itertools
import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

# The exponents of a monomial, one for each variable.
Exponents = tuple[int, ...]
# A coefficient that is 1: no product is needed with it.
ONE = 1.0
# The most monomials of a sum: a table has no more coefficients.
MAX_MONOMIALS = 4096


def powers(
    degree: int, variables: int = 1, total: bool = False
) -> tuple[int, ...] | tuple[Exponents, ...]:
    """Return the exponents of all monomials up to a degree.

    For one variable they are numbers: `powers(2)` is (0, 1, 2). For several they are tuples. The
    degree is that in each variable, or if `total`, the sum of the exponents. Raises ValueError for
    a negative degree, and for less than one variable.
    """
    if degree < 0 or variables < 1:
        raise ValueError(f"powers({degree}, {variables}): allowed are 0 or more, and 1 or more")
    # The first condition keeps the second one from numbers of many digits.
    if degree >= MAX_MONOMIALS or _count(degree, variables, total) > MAX_MONOMIALS:
        raise ValueError(
            f"degree {degree} in {variables} variables: allowed are at most {MAX_MONOMIALS} "
            "monomials"
        )
    if variables == 1:
        return tuple(range(degree + 1))
    return monomials(degree, variables, total)


def _count(degree: int, variables: int, total: bool) -> int:
    return math.comb(degree + variables, variables) if total else (degree + 1) ** variables


def monomials(degree: int, variables: int, total: bool) -> tuple[Exponents, ...]:
    """Return what `powers` does, as tuples for any number of variables, even for none."""
    every = itertools.product(range(degree + 1), repeat=variables)
    return tuple(each for each in every if not total or sum(each) <= degree)


def checked_exponents(given: Sequence, symbols: Sequence[str], what: str) -> tuple[Exponents, ...]:
    """Return exponents as tuples. Raises ValueError if they do not fit the variables `symbols`.

    `what` names them in the message, such as 'my-form: numerator'.
    """
    count, names = len(symbols), ", ".join(symbols)
    allowed = "a whole number" if count == 1 else f"{count} whole numbers"
    found = []
    for each in given:
        exponents = tuple(each) if isinstance(each, Sequence) else (each,)
        if len(exponents) != count or not all(map(_is_exponent, exponents)):
            raise ValueError(
                f"{what} has {each!r}: allowed are {allowed} ≥ 0, exponents of {names}"
            )
        found.append(tuple(int(e) for e in exponents))
    if not found:
        raise ValueError(f"{what} is empty: at least one monomial is needed")
    for twice in (each for each in found if found.count(each) > 1):
        shown = twice[0] if count == 1 else twice
        raise ValueError(f"{what} has {shown!r} twice: allowed is once")
    return tuple(found)


def _is_exponent(given: Any) -> bool:
    return isinstance(given, int | np.integer) and not isinstance(given, bool) and given >= 0


def coefficient_name(letter: str, exponents: Exponents) -> str:
    """Return the name of a monomial's coefficient: 'a2' for z², 'b10' for z¹y⁰, 'b10_2'."""
    digits = [str(each) for each in exponents]
    return letter + ("" if all(len(each) == 1 for each in digits) else "_").join(digits)


def free_letter(preferred: str, taken: Sequence[str]) -> str:
    """Return a letter for coefficients that none of the names begins with, if there is one."""
    letters = [preferred, *"cpqrkmn"]
    return next((each for each in letters if not any(_is_like(t, each) for t in taken)), preferred)


def _is_like(name: str, letter: str) -> bool:
    return name.startswith(letter) and name[1:].replace("_", "").isdigit()


def sum_text(terms: Mapping[Any, str | float], symbols: Sequence[str]) -> str:
    """Write a sum of monomials, such as 'a0 + a1·z + z²'. A coefficient of 1 is left out.

    `terms` maps exponents, one for each symbol, to the coefficients.
    """
    parts = []
    for exponents, coefficient in terms.items():
        factors = [
            symbol if e == 1 else f"{symbol}{str(e).translate(_SUPERSCRIPTS)}"
            for symbol, e in zip(symbols, exponents, strict=True)
            if e
        ]
        if isinstance(coefficient, str):
            factors.insert(0, coefficient)
        parts.append("·".join(factors) or "1")
    return " + ".join(parts)


_SUPERSCRIPTS = str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹")


def nested_horner(terms: Mapping[Exponents, Any], variables: Sequence[Any]) -> Any:
    """Return the sum of monomials, `terms` mapping exponents to coefficients.

    It is a polynomial in one variable whose coefficients are polynomials in the others. Horner's
    rule is applied to each. The order of the variables is the one with the fewest operations.
    """
    return _in_order(terms, _cheapest_order(tuple(terms), len(variables)), variables)


def _in_order(terms: Mapping[Exponents, Any], order: Sequence[int], variables: Sequence[Any]):
    known: dict[tuple[int, int], Any] = {}

    def power(k: int, exponent: int) -> Any:
        if exponent == 1:
            return variables[k]
        if (k, exponent) not in known:
            half, odd = divmod(exponent, 2)
            other = power(k, exponent - 1) if odd else power(k, half)
            known[k, exponent] = other * (variables[k] if odd else other)
        return known[k, exponent]

    def times(total: Any, k: int, exponent: int) -> Any:
        if exponent == 0:
            return total
        if isinstance(total, float) and total == ONE:
            return power(k, exponent)
        return total * power(k, exponent)

    def horner(terms: Mapping[Exponents, Any], order: Sequence[int]) -> Any:
        if not order:
            (only,) = terms.values()
            return only
        k, *rest = order
        groups: dict[int, dict[Exponents, Any]] = {}
        for exponents, coefficient in terms.items():
            groups.setdefault(exponents[k], {})[exponents] = coefficient
        falling = sorted(groups, reverse=True)
        total = horner(groups[falling[0]], rest)
        for high, low in itertools.pairwise(falling):
            total = horner(groups[low], rest) + times(total, k, high - low)
        return times(total, k, falling[-1])

    return horner(terms, order)


@functools.lru_cache(maxsize=1024)
def _cheapest_order(terms: tuple[Exponents, ...], variables: int) -> tuple[int, ...]:
    def cost(order: tuple[int, ...]) -> int:
        tally = _Tally()
        _in_order(dict.fromkeys(terms, tally), order, [tally] * variables)
        return tally.operations

    return min(itertools.permutations(range(variables)), key=cost)


class _Tally:
    """Stands for any number, and counts the operations that are done with it."""

    def __init__(self):
        self.operations = 0

    def _counted(self, _other: Any) -> "_Tally":
        self.operations += 1
        return self

    __add__ = __mul__ = _counted
