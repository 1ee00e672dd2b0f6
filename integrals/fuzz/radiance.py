"""The whole fuzz BRDF integrated over the hemisphere: what the ambient model approximates.

All are quadrature of smooth integrands for d > 0 and directions above the horizon, in float64.
Light enters through its nine spherical harmonics: each result is linear in them.
"""

import functools

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from integrals.fuzz.ps import scattered_fraction
from integrals.reference import require_float64
from integrals.rules.interval import exponential_decay
from shading import (
    direction,
    fiber_direction,
    fiber_phase_function,
    harmonics,
    layer_brdf,
    penetration,
)
from shading.types import Scalar

# At α ≥ 0.15, d ≥ 0.01 and v·n ≥ 0.1, the default is good to 1e-5 (tests/test_brdf.py).
STEP = 1 / 12
AZIMUTHS = 192


@functools.cache
def hemisphere_rule(step: float = STEP, azimuths: int = AZIMUTHS) -> tuple[np.ndarray, np.ndarray]:
    """Give directions (n, 3) and weights (n,), in steradians, that integrate over the hemisphere.

    The double exponential rule of `step` in −ln cos θ, so that what happens at cos θ ~ d is
    resolved for any d; midpoints in azimuth.
    """
    s, weights = exponential_decay(step)
    cosine = np.exp(-s)
    sine = np.sqrt(-np.expm1(-2 * s))
    phi = (np.arange(azimuths) + 0.5) * 2 * np.pi / azimuths
    x, y = np.outer(sine, np.cos(phi)), np.outer(sine, np.sin(phi))
    z = np.broadcast_to(cosine[:, None], x.shape)
    solid = np.repeat(weights * cosine * 2 * np.pi / azimuths, azimuths)
    return np.stack([x, y, z], axis=-1).reshape(-1, 3), solid


def layer_response(
    alpha: Scalar,
    theta_f: Scalar,
    density: Scalar,
    theta_v: Scalar,
    phi_v: Scalar,
    step: float = STEP,
    azimuths: int = AZIMUTHS,
) -> Array:
    """Give ∫_Ω f(u, v) Yᵢ(u) (u·n) dω_u / c_f (9,): the layer's radiance towards v, light by light.

    The fibre-like SGGX phase function; angles in radians.
    """
    require_float64()
    lights, weights = hemisphere_rule(step, azimuths)
    fiber, view = fiber_direction(theta_f), direction(theta_v, phi_v)

    def scattered(light):
        phase = fiber_phase_function(light, view, fiber, alpha)
        return layer_brdf(phase, light[2], view[2], density, 1.0) * light[2] * harmonics(light)

    return weights @ jax.vmap(scattered)(lights)


def phase_over_lights(
    alpha: Scalar,
    theta_f: Scalar,
    theta_v: Scalar,
    phi_v: Scalar,
    step: float = STEP,
    azimuths: int = AZIMUTHS,
) -> Array:
    """Give ∫_Ω p_F(u, v) dω_u, for which the ambient model takes 1 − P_s(v) = ∫_Ω p_F(v, u) dω_u.

    They differ because p_F(u, v) σ_F(u) is symmetric and p_F is not.
    """
    require_float64()
    lights, weights = hemisphere_rule(step, azimuths)
    fiber, view = fiber_direction(theta_f), direction(theta_v, phi_v)
    phase = jax.vmap(fiber_phase_function, (0, None, None, None))
    return jnp.sum(weights * phase(lights, view, fiber, alpha))


def base_response(
    alpha: Scalar, theta_f: Scalar, density: Scalar, step: float = STEP, azimuths: int = AZIMUTHS
) -> tuple[Array, Array]:
    """Give E_p and E_s/c_f (9,) each: what reaches the base unscattered, and scattered once.

    E_p = ∫_Ω P_p(u) Yᵢ(u) (u·n) dω_u, E_s = c_f ∫_Ω (1 − P_p(u)) P_s(u) Yᵢ(u) (u·n) dω_u.
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
    """Give ∫_Ω f(u, v) (v·n) dω_v / c_f, the part of the light from u that the layer reflects."""
    require_float64()
    views, weights = hemisphere_rule(step, azimuths)
    fiber, light = fiber_direction(theta_f), direction(theta_u, phi_u)

    def scattered(view):
        phase = fiber_phase_function(light, view, fiber, alpha)
        return layer_brdf(phase, light[2], view[2], density, 1.0) * view[2]

    return weights @ jax.vmap(scattered)(views)
