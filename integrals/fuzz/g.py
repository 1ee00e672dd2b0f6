"""G, the average of the layer's scattering kernel g over the hemisphere of lights.

G(d, v) = (1/2π) ∫_Ω g(u, v) dω_u (Eq. 3), where g is `shading.scattering_kernel`: the BRDF of the
layer times u·n, without albedo and phase function.
"""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jax.scipy.special import xlogy

from integrals.monte_carlo import Sequence, mean_estimate, unit_points
from integrals.reference import Axis, Estimate, Reference, leg
from integrals.rules.interval import checked_steps, exponential_decay
from integrals.sampling import Sampling
from integrals.special.exponential import e1, e2, ein, gamma2
from shading import optical_path, scattering_kernel
from shading.types import Scalar

DENSITY = Axis(
    "density", 0.0, np.inf, "d", meaning="thickness of the layer over its mean free path", alias="d"
)
COS_V = Axis("cos_v", 0.0, 1.0, "ν", meaning="cosine of view and normal, v·n", alias="nu")
AXES = (DENSITY, COS_V)


@jax.custom_jvp
def ambient_scattering(density: Scalar, cos_v: Scalar) -> Array:
    """Return G in closed form for d > 0 and ν = v·n in (0, 1].

    G = 1 − e^(−d/ν) E₂(d) − ν K with K = ln(1 + 1/ν) + E₁(d + d/ν) − e^(−d/ν) E₁(d). This follows
    from the substitution t = 1/(u·n) and partial fractions (docs/closed-form.md). For d + d/ν < 1
    the terms nearly cancel and leave about d/ν. There the logarithms are taken out of E₁ and
    combined before the terms are added.
    """
    # notation: x = d/ν
    d, nu = jnp.asarray(density), jnp.asarray(cos_v)
    x = optical_path(d, nu)
    thin = d + x < 1
    thin_d, thin_x = jnp.where(thin, d, 0.25), jnp.where(thin, x, 0.5)
    escape = jnp.exp(-thin_x)
    logarithm = np.euler_gamma + jnp.log(thin_d)
    collected = (
        escape * (thin_d + nu) * ein(thin_d)
        - jnp.expm1(-thin_x)
        - escape * jnp.expm1(-thin_d)
        - nu * ein(thin_d + thin_x)
        + nu * logarithm * gamma2(thin_x)
    )
    return jnp.where(thin, collected, 1 - jnp.exp(-x) * e2(d) - nu * _logarithms(d, nu))


def _logarithms(d: Array, nu: Array) -> Array:
    """Return K. For d + d/ν < 1 its logarithms are taken out of E₁, because they cancel."""
    x = optical_path(d, nu)
    thin = d + x < 1
    small, thin_d = jnp.where(thin, d + x, 0.5), jnp.where(thin, d, 0.25)
    escape = jnp.exp(-x)
    cancelled = jnp.expm1(-x) * (np.euler_gamma + jnp.log(d)) + ein(small) - escape * ein(thin_d)
    # log1p(ν) − log(ν) is ln(1 + 1/ν), but 1/ν cannot overflow in it.
    plain = jnp.log1p(nu) - jnp.log(nu) + e1(d + x) - escape * e1(d)
    return jnp.where(thin, cancelled, plain)


@ambient_scattering.defjvp
def _derivative(primals, tangents):
    (d, nu), (dd, dnu) = primals, tangents
    x = optical_path(d, nu)
    escape = jnp.exp(-x)
    by_density = escape * e2(d) / nu
    by_cosine = (
        -jnp.expm1(-d - x) / (1 + nu)
        - _logarithms(d, nu)
        - x * (escape / nu) * (e2(d) - nu * e1(d))
    )
    return ambient_scattering(d, nu), by_density * dd + by_cosine * dnu


def _with_limits(evaluate, density: Array, cos_v: Array) -> Array:
    """Return evaluate(d, ν) where d > 0 and ν > 0, and elsewhere the limit with its derivative.

    As ν → 0, G = 1 + ν ln ν + O(ν), so the derivative in ν goes to −∞. As d → 0,
    G = d/ν + O(d² ln d). The corner d = ν = 0 has no limit: with d/ν = x constant, G → 1 − e^(−x).
    The result there is NaN.
    """
    layer, grazing = density > 0, cos_v <= 0
    inside = layer & ~grazing
    value = evaluate(jnp.where(inside, density, 1.0), jnp.where(inside, cos_v, 1.0))
    edge = 1 + _nu_log_nu(jnp.where(layer & grazing, cos_v, 1.0))
    empty = density * jax.lax.stop_gradient(1 / jnp.where(grazing, 1.0, cos_v))
    edges = jnp.where(layer, edge, jnp.where(grazing, jnp.nan, empty))
    return jnp.where(inside, value, edges)


@jax.custom_jvp
def _nu_log_nu(nu: Array) -> Array:
    return xlogy(nu, nu)


@_nu_log_nu.defjvp
def _steepening(primals, tangents):
    # The exact derivative is ln ν + 1. The 1 is left out, because the term O(ν) of G changes it.
    return _nu_log_nu(*primals), jnp.log(primals[0]) * tangents[0]


@leg(*AXES)
def closed_form(density, cos_v) -> Estimate:
    """Evaluate the closed form. Its relative error is at most 16ε, with ε of float64."""
    value = _with_limits(ambient_scattering, density, cos_v)
    return Estimate(value, 16 * np.finfo(float).eps * value)


@leg(*AXES)
def quadrature(density, cos_v, *, step: float = 1 / 32) -> Estimate:
    """Integrate the kernel over the hemisphere by the double exponential rule with `step`.

    The kernel does not depend on the azimuth, so G is ∫ g d(u·n) over (0, 1]. The kernel changes
    rapidly near u·n ~ d and u·n ~ ν. In the variable s = −ln(u·n) these changes have a width of
    about one, however small d and ν are.
    """

    def rule(step: float) -> Array:
        s, weights = exponential_decay(step)
        cosines = jnp.exp(-s)

        def integral(density, cos_v):
            kernel = jax.vmap(lambda cos_u: scattering_kernel(cos_u, cos_v, density))
            return jnp.sum(weights * cosines * kernel(cosines))

        return _with_limits(integral, density, cos_v)

    return checked_steps(rule, step, 1e-14)


@leg(*AXES)
def monte_carlo(
    density, cos_v, *, samples: int = 1 << 16, sequence: Sequence = "random", seed: int = 0
) -> Estimate:
    """Average the kernel over lights that are uniform over the hemisphere.

    The standard error is reliable only if d and ν are much larger than 1/samples. Otherwise
    too few samples fall where the kernel changes.
    """
    # The points x are in [0, 1), so the cosine 1 − x is not zero.
    cosines = jnp.asarray(1 - unit_points(samples, 1, sequence, seed)[..., 0])

    def kernel(cos_u):
        return _with_limits(lambda d, nu: scattering_kernel(cos_u, nu, d), density, cos_v)

    return mean_estimate(jax.vmap(jax.vmap(kernel))(cosines))


G = Reference(
    name="g",
    symbol="G",
    meaning="average over lights of the layer's BRDF without albedo and phase function",
    definition="(1/2π) ∫_Ω g(u, v) dω_u",
    axes=(replace(DENSITY, scale="logarithmic"), replace(COS_V, scale="logarithmic")),
    sampling=Sampling(fitted=13, checked=15, judged=16),
    closed_form=closed_form,
    quadrature=quadrature,
    monte_carlo=monte_carlo,
    few_calls=True,
)
