"""Forms of R: rational functions of α and of cos²θf.

The square makes them even in cos θf, as R is, because t and −t are the same fibre.
"""

import functools
import itertools
from collections.abc import Iterator

import jax.numpy as jnp
from jax import Array

from fitting.form import Form, Stage
from fitting.greedy_monomials import greedy_sets
from fitting.shapes.monomial_sums import sum_text
from fitting.shapes.monomials import Exponents, horner
from integrals import R
from integrals.reference import restricted
from shading.types import Scalar

# The choices of the variable z: its symbol, and z as a function of α and b = 1 − α. All are 0 at
# α = 1.
VARIABLES = {
    "1-alpha": ("1 − α", lambda alpha, b: b),
    "1-alpha^2": ("1 − α²", lambda alpha, b: 1 - alpha * alpha),
    "(1-alpha)/(1+alpha)": ("(1 − α)/(1 + α)", lambda alpha, b: b / (1 + alpha)),
}
# The exponents (i, j) of the monomials zⁱyʲ from which a search chooses.
NUMERATOR = tuple((i, j) for i in range(4) for j in range(4))
DENOMINATOR = tuple((i, j) for i in range(3) for j in range(3) if i + j)


@functools.cache
def monomial_r(
    *, variable: str, numerator: Exponents, denominator: Exponents, least_alpha: float
) -> Form:
    """Return R̃ = ½ + z N(z, y)/D(z, y), with z of VARIABLES and y = cos²θf, for α ≥ `least_alpha`.

    `numerator` and `denominator` hold the exponents (i, j) of the monomials zⁱyʲ that have a
    coefficient. D also has the constant 1. R̃ = ½ at α = 1, which is exact. The coefficients of N
    come first, then those of D.
    """
    symbol, z_of = VARIABLES[variable]
    split = len(numerator)

    def value(c, alpha: Scalar, theta_f: Scalar) -> Array:
        # notation: b = 1 − α and g = cos θf, as in the supplement's listings.
        alpha = jnp.asarray(alpha)
        b = 1 - alpha
        g = jnp.cos(theta_f)
        z = z_of(alpha, b)
        y = g * g
        above = dict(zip(numerator, c[:split], strict=True))
        below = {(0, 0): 1.0, **dict(zip(denominator, c[split:], strict=True))}
        N = horner(above, z, y)
        D = horner(below, z, y)
        return 0.5 + z * N / D

    sets = {"N": numerator, "D": denominator}
    return Form(
        name="monomial-r",
        equation=_equation(symbol, numerator, denominator),
        reference=R,
        axes=restricted(R.axes, alpha=(least_alpha, 1.0)),
        coefficient_names=[
            f"{part}: z^{i} y^{j}" for part, exponents in sets.items() for i, j in exponents
        ],
        stages=(Stage(value),),
        shape={
            "variable": variable,
            "numerator": [list(each) for each in numerator],
            "denominator": [list(each) for each in denominator],
            "least_alpha": least_alpha,
        },
    )


def _equation(symbol: str, numerator: Exponents, denominator: Exponents) -> str:
    """Write the form as text. The variable 1 − α is called b, as in the exported code."""
    z = "b" if symbol == "1 − α" else "z"
    names = iter(range(len(numerator) + len(denominator)))
    above = {each: f"C[{next(names)}]" for each in numerator}
    below = {(0, 0): 1.0, **{each: f"C[{next(names)}]" for each in denominator}}
    return (
        f"g = cos(θf); {z} = {symbol}; y = g²; N = {sum_text(above, (z, 'y'))}; "
        f"D = {sum_text(below, (z, 'y'))}; R = 1/2 + {z}·N/D"
    )


def candidates(least_alpha: float, known: tuple[Form, ...] = ()) -> Iterator[Form]:
    """Yield the forms that a search tries: the `known` ones, then some of each variable.

    In each variable, the number of monomials grows from form to form.
    """
    grown = (
        monomial_r(variable=variable, numerator=above, denominator=below, least_alpha=least_alpha)
        for variable in VARIABLES
        for above, below in greedy_sets(
            monomial_r(
                variable=variable,
                numerator=NUMERATOR,
                denominator=DENOMINATOR,
                least_alpha=least_alpha,
            ),
            NUMERATOR,
            DENOMINATOR,
            start=(((0, 0), (0, 1)), ((1, 0),)),
        )
    )
    return itertools.chain(known, grown)
