"""Forms of A and B that agree with a form of E: B = E t⁵ and A = E (1 − t⁵), with 0 ≤ t ≤ 1.

t is one minus an effective cosine, as in Schlick's (1 − v·h)⁵. It is V/T with sums of monomials
V and T of μ and σ. If V ≥ 0 and T ≥ V, then 0 ≤ A ≤ E and 0 ≤ B ≤ E.
E is that of a best table, with its coefficients as constants, so that this holds beside that table.
"""

import functools
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from jax import Array

from fitting.form import Form, Proofs, Stage
from fitting.shapes.monomial_sums import ONE, nested_horner
from fitting.shapes.monomials import Exponents
from integrals.microfacet.references import GGX_BIAS, GGX_SCALE
from integrals.reference import Reference
from quantities.microfacet.albedo_forms import (
    AXES,
    CHOSEN,
    Lobe,
    lobe,
    masked,
    monomial_names,
    sums,
    terms_of,
)
from quantities.microfacet.equations import Terms, coefficients, constants, split_equation
from shading.types import Scalar

# E of A and B: the monomials, and the coefficients of best/ggx-directional-albedo-57.
ALBEDO = CHOSEN[4]
ALBEDO_COEFFICIENTS = (
    *(0.027818750590085983, 0.8142716288566589, 0.2786685824394226, 1.2221697568893433),
    *(7.771441459655762, 0.18012338876724243, 5.288364410400391, 1.9876830577850342),
    *(0.275611937046051, 0.41350334882736206, -1.0251317024230957),
)

# About 1 − t, for the start of a fit: it is μ for smooth surfaces, and has these two constants at
# grazing views.
_GRAZING, _HALF = 0.58, 0.28
_NODES = 24


def albedo(at: Lobe) -> Array:
    """Return E with the coefficients of the best table."""
    return masked(at, *sums(ALBEDO_COEFFICIENTS, at, *ALBEDO))


def _parts(c: Any, at: Lobe, numerator: Exponents, denominator: Exponents) -> tuple[Any, Any]:
    """Return V and T, with the coefficients of V first."""
    above, below = _terms(c, numerator, denominator)
    variables = (at.mu, at.sigma)
    return nested_horner(above, variables), nested_horner(below, variables)


def _terms(c: Any, numerator: Exponents, denominator: Exponents) -> tuple[Terms, Terms]:
    """Return the terms of V and T: the exponents of μ and σ, and the coefficients."""
    split = len(numerator)
    free = (c[split + k] for k in range(len(denominator) - 1))
    above = dict(zip(numerator, (c[k] for k in range(split)), strict=True))
    return above, dict(zip(denominator, (ONE, *free), strict=True))


def _fifth(c: Any, at: Lobe, numerator: Exponents, denominator: Exponents) -> Array:
    v, t = _parts(c, at, numerator, denominator)
    t = v / t
    t2 = t * t
    return t2 * t2 * t


def _start(numerator: Exponents, denominator: Exponents) -> np.ndarray:
    """Return coefficients with t near a simple function: linear least squares in V − tT."""
    alpha = np.repeat(np.geomspace(AXES[1].lower, 1.0, _NODES), _NODES)
    mu = np.tile(np.linspace(0.0, 1.0, _NODES) ** 2, _NODES)
    sigma = np.sqrt(alpha**2 + (1 - alpha**2) * mu**2)
    rough = sigma - mu
    t = (1 - mu) * (1 - _GRAZING * rough / (rough + _HALF))
    columns = [mu**i * sigma**j for i, j in numerator]
    columns += [-t * mu**i * sigma**j for i, j in denominator[1:]]
    one = mu ** denominator[0][0] * sigma ** denominator[0][1]
    weight = t**4 + 0.01
    matrix = np.stack(columns, axis=1) * weight[:, None]
    # The ridge keeps coefficients small: the simple function is not worth large ones.
    ridge = 1e-3 * np.eye(len(columns))
    values = np.concatenate([t * one * weight, np.zeros(len(columns))])
    return np.linalg.lstsq(np.concatenate([matrix, ridge]), values, rcond=None)[0]


def _masked(
    owner: Reference,
    symbol: str,
    text: str,
    combine: Callable[[Array, Array], Array],
    numerator: Exponents,
    denominator: Exponents,
) -> Form:
    def value(c, mu: Scalar, alpha: Scalar) -> Array:
        at = lobe(mu, alpha)
        return combine(albedo(at), _fifth(c, at, numerator, denominator))

    def margins(c, mu: Scalar, alpha: Scalar) -> tuple[Array, ...]:
        at = lobe(mu, alpha)
        v, t = _parts(c, at, numerator, denominator)
        return (v, t - v, *sums(ALBEDO_COEFFICIENTS, at, *ALBEDO))

    size = len(numerator) + len(denominator) - 1
    return Form(
        name=f"masked-{owner.name}",
        equation=split_equation(
            symbol,
            text,
            *terms_of(constants(ALBEDO_COEFFICIENTS), *ALBEDO),
            *_terms(coefficients(0, size), numerator, denominator),
        ),
        reference=owner,
        axes=AXES,
        coefficient_names=[
            *monomial_names("V", numerator, "μσ"),
            *monomial_names("T", denominator[1:], "μσ"),
        ],
        stages=(Stage(value),),
        starts=(_start(numerator, denominator),),
        shape={
            "numerator": [list(each) for each in numerator],
            "denominator": [list(each) for each in denominator],
        },
        proofs=Proofs(margins=margins),
    )


@functools.cache
def masked_bias(*, numerator: Exponents, denominator: Exponents) -> Form:
    """Return the form B = E t⁵. The exponents (i, j) are those of μⁱσʲ in V and in T.

    The first monomial of T has the coefficient 1.
    """
    return _masked(GGX_BIAS, "B", "E·t⁵", lambda e, t: e * t, numerator, denominator)


@functools.cache
def masked_scale(*, numerator: Exponents, denominator: Exponents) -> Form:
    """Return the form A = E (1 − t⁵), with the arguments of `masked_bias`."""
    return _masked(GGX_SCALE, "A", "E·(1 − t⁵)", lambda e, t: e * (1 - t), numerator, denominator)


# The monomials of V and T that a search tries, found by leaving out single ones of all up to the
# third degree, with the least largest error at each size.
CHOSEN_SPLITS: tuple[tuple[Exponents, Exponents], ...] = (
    (
        ((0, 2), (1, 1), (0, 3), (1, 2), (2, 1)),
        ((0, 2), (1, 1), (0, 3), (1, 2)),
    ),
    (
        ((0, 0), (0, 2), (1, 1), (0, 3), (1, 2), (2, 1)),
        ((0, 2), (0, 0), (1, 1), (0, 3), (1, 2)),
    ),
    (
        ((0, 1), (0, 2), (1, 1), (2, 0), (0, 3), (1, 2), (2, 1), (3, 0)),
        ((0, 1), (0, 2), (1, 1), (0, 3), (1, 2), (2, 1), (3, 0)),
    ),
)


def candidates(make: Callable[..., Form]) -> Iterator[Form]:
    """Yield the forms of A or B that a search tries; `make` is `masked_bias` or `masked_scale`."""
    for numerator, denominator in CHOSEN_SPLITS:
        yield make(numerator=numerator, denominator=denominator)
