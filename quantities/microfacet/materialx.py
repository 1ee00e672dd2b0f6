"""The forms of MaterialX: A and B as quotients of biquadratic polynomials, and E = A + B."""

from collections.abc import Callable
from typing import Any

import jax.numpy as jnp
from jax import Array

from fitting.form import Form, Stage
from fitting.points.grids import Grid, gauss_grid
from fitting.solvers.on_grid import MARQUARDT, OnGrid, solve_in_general
from integrals.microfacet.references import GGX_BIAS, GGX_DIRECTIONAL_ALBEDO, GGX_SCALE
from integrals.reference import Reference
from quantities.microfacet.albedo_forms import AXES, monomial_names
from quantities.microfacet.equations import biquadratic_equation, both_equation
from shading.types import Scalar

# The exponents of μ and α, in the order of MaterialX's code.
MONOMIALS = ((0, 0), (1, 0), (0, 1), (1, 1), (2, 0), (0, 2), (2, 1), (1, 2), (2, 2))
# A quotient has the coefficients of its numerator, and those of its denominator but the constant 1.
SIZE = 2 * len(MONOMIALS) - 1


def _monomials(mu: Scalar, alpha: Scalar) -> Array:
    x, y = jnp.asarray(mu), jnp.asarray(alpha)
    x2, y2 = x * x, y * y
    return jnp.stack([x, y, x * y, x2, y2, x2 * y, x * y2, x2 * y2])


def quotient(c: Any, mu: Scalar, alpha: Scalar) -> Array:
    """Return the quotient of two biquadratic polynomials with the coefficients `c` (17,)."""
    terms, split = _monomials(mu, alpha), len(MONOMIALS)
    return (c[0] + c[1:split] @ terms) / (1 + c[split:] @ terms)


def _clamped(c: Any, mu: Scalar, alpha: Scalar) -> Array:
    return jnp.clip(quotient(c, mu, alpha), 0.0, 1.0)


def _both(c: Any, mu: Scalar, alpha: Scalar) -> Array:
    return _clamped(c[:SIZE], mu, alpha) + _clamped(c[SIZE:], mu, alpha)


def _names(part: str = "") -> list[str]:
    above, below = monomial_names(f"N{part}", MONOMIALS), monomial_names(f"D{part}", MONOMIALS[1:])
    return [*above, *below]


def _form(name: str, reference: Reference, equation: str, names: list[str], call: Callable, solver):
    return Form(
        name=name,
        equation=equation,
        reference=reference,
        axes=AXES,
        coefficient_names=names,
        stages=(Stage(call),),
        solver=solver,
    )


def _fit_both(grid: Grid, exact: Array) -> Array:
    """Return coefficients (34,) of E = A + B: fit A and B first, then their sum to E."""
    bias = jnp.asarray(GGX_BIAS.values(grid.points))
    parts = [
        solve_in_general(form, grid, values)[0]
        for form, values in ((BIQUADRATIC_SCALE, exact - bias), (BIQUADRATIC_BIAS, bias))
    ]
    return jnp.concatenate(parts)


BIQUADRATIC_SCALE = _form(
    "biquadratic-ggx-scale",
    GGX_SCALE,
    biquadratic_equation("A", MONOMIALS),
    _names(),
    quotient,
    OnGrid(gauss_grid),
)
BIQUADRATIC_BIAS = _form(
    "biquadratic-ggx-bias",
    GGX_BIAS,
    biquadratic_equation("B", MONOMIALS),
    _names(),
    quotient,
    OnGrid(gauss_grid),
)
SPLIT_ALBEDO = _form(
    "split-ggx-directional-albedo",
    GGX_DIRECTIONAL_ALBEDO,
    both_equation(MONOMIALS),
    [*_names(" of A"), *_names(" of B")],
    _both,
    OnGrid(gauss_grid, _fit_both, MARQUARDT),
)
