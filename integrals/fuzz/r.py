"""R, the cosine-weighted average of P_s over the hemisphere of lights.

R(θf, α) = (1/π) ∫_Ω P_s(u) (u·n) dω_u (Eq. 5).
"""

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from integrals.fuzz.lights_about_fibre import estimates_about_fibre
from integrals.fuzz.ps import ALPHA, THETA_F, fraction_at
from integrals.monte_carlo import Sequence, indicator, mean_estimate, unit_points
from integrals.reference import Estimate, Reference, Smooth, leg
from integrals.rules.interval import checked_rule, gauss_legendre
from integrals.sampling import Sampling
from shading import direction, fiber_direction, fiber_root, reflect, visible_normal

AXES = (ALPHA, THETA_F)


def average_over_lights(fraction, nodes: int) -> Array:
    """Return (1/π) ∫_Ω fraction(θu, φ) (u·n) dω_u for a function that is even in φ.

    `fraction` takes scalars, in radians. The rule has `nodes` Gauss–Legendre nodes in cos θu and
    `nodes` midpoints in φ on [0, π].
    """
    cosines, weights = gauss_legendre(nodes, 0.0, 1.0)
    azimuths = (np.arange(nodes) + 0.5) * np.pi / nodes
    over_azimuth = jax.vmap(fraction, (None, 0))
    values = jax.vmap(over_azimuth, (0, None))(np.arccos(cosines), azimuths)
    return 2 * jnp.sum((weights * cosines)[:, None] * values) / nodes


@leg(*AXES)
def quadrature(alpha, theta_f, *, nodes: int = 96) -> Estimate:
    """Average the closed form of P_s with `nodes`² points.

    The error comes from the difference to the rule with (¾ nodes)² points.
    """

    def fraction(theta_u, phi):
        return fraction_at(alpha, theta_f, theta_u, phi)

    # P_s changes within an angle of α about the fibre. The second term bounds what a rule misses
    # whose nodes are too far apart for this; the factor 6 is too small if they are very far apart
    # (the error is 14.3 α² e^(−4 nodes α) at α = 0.0445, θf = 1.3477 with 96 nodes).
    factor = jnp.where(nodes * alpha < 4.8, 16.0, 6.0)
    rounding = 4 * np.finfo(float).eps / alpha + factor * alpha**2 * jnp.exp(-4 * nodes * alpha)
    return checked_rule(lambda count: average_over_lights(fraction, count), nodes, rounding)


@leg(*AXES)
def monte_carlo(
    alpha, theta_f, *, samples: int = 1 << 16, sequence: Sequence = "random", seed: int = 0
) -> Estimate:
    """Draw lights with the density (u·n)/π, reflect each about a visible normal, and count.

    The result is the part of the reflections that goes down. Not differentiable.
    """
    root = fiber_root(fiber_direction(theta_f), alpha)

    def goes_down(point):
        light = direction(jnp.arcsin(jnp.sqrt(point[0])), 2 * jnp.pi * point[1])
        normal = visible_normal(root, light, point[2:])
        return indicator(-reflect(light, normal)[2])

    points = unit_points(samples, 4, sequence, seed)
    return mean_estimate(jax.vmap(jax.vmap(goes_down))(points))


# `Reference.estimates` uses 32² nodes where all points have α ≥ 0.15: the error of R is then below
# 2e-8 (tests/integrals/test_r.py). It uses 96² nodes if any α is lower.
_NODES, _NODES_LOW_ALPHA, _LOW_ALPHA = 32, 96, 0.15


def _nodes_at(points: np.ndarray) -> dict[str, int]:
    alpha, _ = points.T
    low = np.min(alpha) < _LOW_ALPHA
    return {"nodes": _NODES_LOW_ALPHA if low else _NODES}


R = Reference(
    name="r",
    symbol="R",
    meaning="cosine-weighted average of P_s over the hemisphere of lights",
    definition="(1/π) ∫_Ω P_s(u) (u·n) dω_u",
    axes=AXES,
    # Few points and little hill climbing: R is smooth, and each value costs a quadrature.
    sampling=Sampling(
        fitted=11, checked=10, judged=12, climbs=False, refined=1 << 10, verified=1 << 12
    ),
    batch=64,
    options_at=_nodes_at,
    proof_options={"nodes": _NODES_LOW_ALPHA},
    quadrature=quadrature,
    monte_carlo=monte_carlo,
    # R is analytic in θf where |sinh Im θf| < α/√(1 − α²), and in α where Re α > 0
    # (docs/r-theorem.md).
    smooth_along=(Smooth("theta_f"), Smooth("alpha", logarithmic=True)),
    many=estimates_about_fibre,
    few_calls=True,
)
