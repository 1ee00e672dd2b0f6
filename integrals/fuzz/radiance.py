"""Integrals of the whole fuzz BRDF over the hemisphere, which the ambient model approximates.

All are computed in float64 by `hemisphere_rule`, for densities d > 0 and directions above the
horizon. `step` and `azimuths` are the arguments of that rule. Angles are in radians.

Where light has nine coefficients of spherical harmonics, a result (9,) has one value for each
harmonic. Its dot product with the coefficients is the result for that light.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp
from jax import Array

from integrals.reference import require_float64
from integrals.rules.hemisphere import AZIMUTHS, STEP, hemisphere_rule
from shading import (
    direction,
    fiber_direction,
    fiber_phase_function,
    harmonics,
    layer_brdf,
    penetration,
    scattering_kernel,
)
from shading.fuzz.lit_cone import scattered_fraction
from shading.types import Scalar


def layer_response(
    alpha: Scalar,
    theta_f: Scalar,
    density: Scalar,
    theta_v: Scalar,
    phi_v: Scalar,
    step: float = STEP,
    azimuths: int = AZIMUTHS,
) -> Array:
    """Return ∫_Ω f(u, v) Yᵢ(u) (u·n) dω_u / c_f (9,), the radiance of the layer towards v.

    The phase function is that of fibres. v has the angles `theta_v` and `phi_v`.
    """
    require_float64()
    lights, weights = hemisphere_rule(step, azimuths)
    fiber, view = fiber_direction(theta_f), direction(theta_v, phi_v)

    def scattered(light):
        phase = fiber_phase_function(light, view, fiber, alpha)
        return layer_brdf(phase, light[2], view[2], density, 1.0) * light[2] * harmonics(light)

    return weights @ jax.vmap(scattered)(lights)


class LayerMoments(NamedTuple):
    """Moments of the lights that the layer sends to a view, of p(u, v) g(u, v) over the upper u.

    Attributes:
        total: M0 = ∫_Ω p g dω_u, the radiance of the layer in light of radiance one, over c_f.
        first: M1 = ∫_Ω p g u dω_u (3,). M1/M0 is the mean direction of the light.
        second: M2 = ∫_Ω p g u uᵀ dω_u (3, 3). Its trace is M0.
    """

    total: Array
    first: Array
    second: Array


def layer_moments(
    alpha: Scalar,
    theta_f: Scalar,
    density: Scalar,
    theta_v: Scalar,
    phi_v: Scalar,
    step: float = STEP,
    azimuths: int = AZIMUTHS,
) -> LayerMoments:
    """Return the moments of the lights that the layer sends towards v, over c_f.

    The phase function is that of fibres, and g is `scattering_kernel`. They describe the layer in
    light of at most the second degree in u, so nine harmonics have no more to tell.
    """
    require_float64()
    lights, weights = hemisphere_rule(step, azimuths)
    fiber, view = fiber_direction(theta_f), direction(theta_v, phi_v)

    def scattered(light):
        phase = fiber_phase_function(light, view, fiber, alpha)
        return phase * scattering_kernel(light[2], view[2], density)

    mass = weights * jax.vmap(scattered)(lights)
    return LayerMoments(jnp.sum(mass), mass @ lights, (lights.T * mass) @ lights)


def phase_over_lights(
    alpha: Scalar,
    theta_f: Scalar,
    theta_v: Scalar,
    phi_v: Scalar,
    step: float = STEP,
    azimuths: int = AZIMUTHS,
) -> Array:
    """Return ∫_Ω p_F(u, v) dω_u, the integral of the phase function over lights.

    The ambient model uses 1 − P_s(v) = ∫_Ω p_F(v, u) dω_u instead. The two differ, because p_F is
    not symmetric. Only p_F(u, v) σ_F(u) is. `fuzz.lit` has a rule that is much more precise.
    """
    require_float64()
    lights, weights = hemisphere_rule(step, azimuths)
    fiber, view = fiber_direction(theta_f), direction(theta_v, phi_v)
    phase = jax.vmap(fiber_phase_function, (0, None, None, None))
    return jnp.sum(weights * phase(lights, view, fiber, alpha))


def base_response(
    alpha: Scalar, theta_f: Scalar, density: Scalar, step: float = STEP, azimuths: int = AZIMUTHS
) -> tuple[Array, Array]:
    """Return E_p and E_s/c_f, (9,) each, the irradiance of the base.

    E_p is by light that is not scattered, and E_s by light that is scattered once:
    E_p = ∫_Ω P_p(u) Yᵢ(u) (u·n) dω_u and E_s = c_f ∫_Ω (1 − P_p(u)) P_s(u) Yᵢ(u) (u·n) dω_u.
    """
    require_float64()
    lights, weights = hemisphere_rule(step, azimuths)
    fiber = fiber_direction(theta_f)

    def reaching(light):
        passing = penetration(light[2], density)
        down = scattered_fraction(light[2], light @ fiber, fiber[2], alpha)
        lit = harmonics(light) * light[2]
        return passing * lit, (1 - passing) * down * lit

    unscattered, scattered = jax.vmap(reaching)(lights)
    return weights @ unscattered, weights @ scattered


def layer_albedo(
    alpha: Scalar,
    theta_f: Scalar,
    density: Scalar,
    theta_u: Scalar,
    phi_u: Scalar,
    step: float = STEP,
    azimuths: int = AZIMUTHS,
) -> Array:
    """Return ∫_Ω f(u, v) (v·n) dω_v / c_f, the part of the light from u that the layer reflects."""
    require_float64()
    views, weights = hemisphere_rule(step, azimuths)
    fiber, light = fiber_direction(theta_f), direction(theta_u, phi_u)

    def scattered(view):
        phase = fiber_phase_function(light, view, fiber, alpha)
        return layer_brdf(phase, light[2], view[2], density, 1.0) * view[2]

    return weights @ jax.vmap(scattered)(views)
