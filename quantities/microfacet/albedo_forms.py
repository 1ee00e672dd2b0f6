"""Forms of E that cannot create energy, whatever their coefficients.

The reflections of the visible normals that stay above the surface are the fraction 2N/(μ + σ), in
closed form (docs/microfacet.md). E is less, because lights are masked too: E = 2N/(μs + σ) with
s ≥ 1. The form has s = 1 + α² R/Q with sums of monomials R and Q. So E = 1 at μ = 0, and if R ≥ 0
and Q > 0, all values are in [0, 1].
"""

import functools
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import jax.numpy as jnp
import numpy as np
from jax import Array

from fitting.form import Form, Proofs, Stage
from fitting.shapes.monomial_sums import ONE, nested_horner, sum_text
from fitting.shapes.monomials import Exponents
from integrals.microfacet.references import GGX_DIRECTIONAL_ALBEDO
from integrals.reference import restricted
from quantities.microfacet.equations import Terms, albedo_equation, coefficients
from shading.types import Scalar

# E has a dip at μ ≈ α. No form with few coefficients has it for every α, however small.
LEAST_ALPHA = 0.01
AXES = restricted(GGX_DIRECTIONAL_ALBEDO.axes, alpha=(LEAST_ALPHA, 1.0))
# The monomials of R are at least of this degree, those of Q too.
_DEGREE_OF_R, _DEGREE_OF_Q = 1, 3
# At small α and μ, s is 1.2 (docs/microfacet.md).
_START_OF_R = 0.2


@dataclass(frozen=True)
class Lobe:
    """What the forms have in common at a point: μ, α, σ, p = μ/σ, a = α/σ, and a²."""

    mu: Array
    alpha: Array
    kappa: Array
    sigma: Array
    p: Array
    a: Array
    a2: Array


def lobe(mu: Scalar, alpha: Scalar) -> Lobe:
    """Return what the forms have in common. p and a are in [0, 1], however small α is."""
    mu, alpha = jnp.asarray(mu), jnp.asarray(alpha)
    a2 = alpha * alpha
    kappa = 1 - a2
    sigma = jnp.sqrt(a2 + kappa * mu * mu)
    p, a = mu / sigma, alpha / sigma
    return Lobe(mu, alpha, kappa, sigma, p, a, a * a)


def masked(at: Lobe, r: Any, q: Any) -> Array:
    """Return E = 2N/(μ (1 + a² r/q) + σ), with one division besides those of the lobe."""
    # notation: 2N/σ = w²/(2 d)
    kp = at.kappa * at.p
    d = jnp.sqrt(kp * kp + 4 * at.a2)
    w = kp + d
    return w * w * q / ((d + d) * (q + at.p * (q + at.a2 * r)))


def sums(c: Any, at: Lobe, numerator: Exponents, denominator: Exponents) -> tuple[Any, Any]:
    """Return R/σ and Q/σ³. The first monomial of Q has the coefficient 1.

    `c` has the coefficients of R, then those of Q.
    """
    above, below = terms_of(c, numerator, denominator)
    factors = (at.p, at.a, at.mu, at.alpha)
    return nested_horner(above, factors), nested_horner(below, factors)


def terms_of(c: Any, numerator: Exponents, denominator: Exponents) -> tuple[Terms, Terms]:
    """Return the terms of R/σ and Q/σ³: the exponents of p, a, μ and α, and the coefficients."""
    split = len(numerator)
    free = (c[split + k] for k in range(len(denominator) - 1))
    above = [c[k] for k in range(split)]
    return (
        _scaled(numerator, above, _DEGREE_OF_R),
        _scaled(denominator, [ONE, *free], _DEGREE_OF_Q),
    )


def _scaled(exponents: Exponents, coefficients: list, degree: int) -> Terms:
    """Return the terms of Σ c μⁱαʲ/σ^degree: so many factors μ and α are replaced by p and a.

    None of the factors is small then, even in half precision, unless the monomial is.
    """
    terms: dict[tuple[int, ...], Any] = {}
    for (i, j), c in zip(exponents, coefficients, strict=True):
        p = min(i, degree)
        a = min(j, degree - p)
        terms[(p, a, i - p, j - a)] = c
    return terms


def monomial_names(letter: str, exponents: Exponents, symbols: str = "μα") -> list[str]:
    """Return the names of coefficients, such as 'R: μα³'."""
    return [f"{letter}: {sum_text({each: 1.0}, symbols).replace('·', '')}" for each in exponents]


def _start(numerator: Exponents, denominator: Exponents) -> np.ndarray:
    """Return coefficients with R and Q positive: of Q, those of the lowest degree are one."""
    above = [_START_OF_R for _ in numerator]
    return np.array([*above, *(float(i + j <= _DEGREE_OF_Q) for i, j in denominator[1:])])


@functools.cache
def masked_albedo(*, numerator: Exponents, denominator: Exponents) -> Form:
    """Return the form E = 2N/(μs + σ), s = 1 + α² R(μ, α)/Q(μ, α).

    `numerator` and `denominator` hold the exponents (i, j) of the monomials μⁱαʲ of R and of Q. The
    first of Q has the coefficient 1. The coefficients of R come first, then those of Q.
    """

    def value(c, mu: Scalar, alpha: Scalar) -> Array:
        at = lobe(mu, alpha)
        return masked(at, *sums(c, at, numerator, denominator))

    def margins(c, mu: Scalar, alpha: Scalar) -> tuple[Array, ...]:
        return sums(c, lobe(mu, alpha), numerator, denominator)

    names = coefficients(0, len(numerator) + len(denominator) - 1)
    return Form(
        name="masked-ggx-directional-albedo",
        equation=albedo_equation(*terms_of(names, numerator, denominator)),
        reference=GGX_DIRECTIONAL_ALBEDO,
        axes=AXES,
        coefficient_names=[
            *monomial_names("R", numerator),
            *monomial_names("Q", denominator[1:]),
        ],
        stages=(Stage(value),),
        starts=(_start(numerator, denominator),),
        shape={
            "numerator": [list(each) for each in numerator],
            "denominator": [list(each) for each in denominator],
        },
        proofs=Proofs(margins=margins),
    )


# The sets of monomials that a search tries, found by leaving out and exchanging single monomials of
# larger sets, with the least largest error at each size.
CHOSEN: tuple[tuple[Exponents, Exponents], ...] = (
    (((0, 1), (0, 3), (1, 1), (1, 3)), ((4, 0), (0, 3), (1, 3))),
    (((0, 1), (0, 3), (1, 1), (1, 3)), ((4, 0), (0, 3), (1, 3), (2, 1))),
    (
        ((0, 1), (0, 3), (1, 0), (1, 1), (1, 3)),
        ((1, 2), (0, 3), (1, 3), (3, 0), (4, 0)),
    ),
    (
        ((0, 1), (0, 3), (1, 0), (1, 1), (1, 3)),
        ((1, 2), (0, 3), (1, 3), (3, 0), (4, 0), (4, 2)),
    ),
    (
        ((0, 1), (0, 3), (1, 0), (1, 1), (1, 3)),
        ((1, 2), (0, 3), (1, 3), (2, 4), (3, 0), (4, 0), (4, 2)),
    ),
    (
        ((0, 1), (0, 3), (1, 0), (1, 1), (1, 3)),
        ((1, 2), (0, 3), (1, 3), (2, 1), (2, 3), (2, 4), (3, 0), (3, 3), (4, 0)),
    ),
    (
        ((0, 1), (0, 3), (0, 5), (1, 0), (1, 1), (1, 2), (1, 3), (3, 1)),
        ((1, 2), (0, 3), (0, 5), (1, 3), (1, 4), (2, 1), (2, 3), (2, 4), (3, 0), (3, 3), (4, 0)),
    ),
)


def candidates() -> Iterator[Form]:
    """Yield the forms of E that a search tries."""
    for numerator, denominator in CHOSEN:
        yield masked_albedo(numerator=numerator, denominator=denominator)
