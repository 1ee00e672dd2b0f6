"""The equations of the forms of GGX's albedos, as text (fitting/equation.py has the grammar)."""

from collections.abc import Mapping, Sequence
from typing import Any

from fitting.equation import equation_of
from fitting.shapes.monomial_sums import Exponents, sum_text

# N of the visible normals (docs/microfacet.md) is σ w²/(4 d).
_LOBE = (
    "κ = 1 − α²",
    "σ = √(α² + κ·μ²)",
    "p = μ/σ",
    "a = α/σ",
    "d = √(κ²·p² + 4·a²)",
    "w = κ·p + d",
)
_ALBEDO = "w²·Q/(2·d·(Q + p·(Q + a²·R)))"
_FACTORS = ("p", "a", "μ", "α")

# Exponents, one for each variable, and the coefficients: texts, or numbers that are 1.
Terms = Mapping[Any, Any]


def coefficients(first: int, count: int) -> list[str]:
    """Return what an equation calls `count` coefficients from number `first` on."""
    return [f"C[{k}]" for k in range(first, first + count)]


def constants(values: Sequence[float]) -> list[str]:
    """Return numbers as an equation writes them."""
    return [repr(float(each)).replace("-", "−") for each in values]


def albedo_equation(r: Terms, q: Terms) -> str:
    """Return the equation of `masked_albedo`. The terms have the exponents of p, a, μ and α."""
    return equation_of("E", _ALBEDO, [*_LOBE, *_sums(r, q)])


def split_equation(symbol: str, value: str, r: Terms, q: Terms, v: Terms, t: Terms) -> str:
    """Return the equation of a form of A or B, whose `value` is in E and t = V/T."""
    shared = [*_LOBE, *_sums(r, q), f"E = {_ALBEDO}"]
    parts = [f"V = {_sum(v, ('μ', 'σ'))}", f"T = {_sum(t, ('μ', 'σ'))}", "t = V/T"]
    return equation_of(symbol, value, [*shared, *parts])


def average_equation(above: int, below: int, constant: float | None) -> str:
    """Return the equation of `average_form`; `constant` is c₀, or None without the logarithm."""
    numerator: Terms = dict(zip(((k,) for k in range(above)), coefficients(0, above), strict=True))
    free = zip(((k + 1,) for k in range(below)), coefficients(above, below), strict=True)
    denominator: Terms = {(0,): 1.0, **dict(free)}
    parts = [f"N = {_sum(numerator, 'α')}", f"D = {_sum(denominator, 'α')}"]
    quotient = "N/D" if below else "N"
    shown = f"({constant!r} − ln(α) + α·{quotient})" if constant is not None else quotient
    return equation_of("E_avg", f"1 − α²·{shown}", parts if below else parts[:1])


def biquadratic_equation(symbol: str, exponents: Sequence[Exponents]) -> str:
    """Return the equation of one of MaterialX's quotients."""
    return equation_of(symbol, _quotient(exponents, 0))


def both_equation(exponents: Sequence[Exponents]) -> str:
    """Return the equation of the sum of MaterialX's two quotients, each clamped to [0, 1]."""
    parts = [
        f"{symbol} = min(max({_quotient(exponents, first)}, 0), 1)"
        for symbol, first in (("A", 0), ("B", 2 * len(exponents) - 1))
    ]
    return equation_of("E", "A + B", parts)


def _quotient(exponents: Sequence[Exponents], first: int) -> str:
    split = len(exponents)
    above = dict(zip(exponents, coefficients(first, split), strict=True))
    free = coefficients(first + split, split - 1)
    below = {exponents[0]: 1.0, **dict(zip(exponents[1:], free, strict=True))}
    return f"({_sum(above, 'μα')})/({_sum(below, 'μα')})"


def _sums(r: Terms, q: Terms) -> tuple[str, str]:
    return f"R = {_sum(r, _FACTORS)}", f"Q = {_sum(q, _FACTORS)}"


def _sum(terms: Terms, symbols: Sequence[str]) -> str:
    return sum_text(terms, symbols).replace("+ −", "− ")
