"""P_s, the fraction of the scattered light that a layer of fibres sends down to the base.

P_s(u; α, θf) = 1 − ∫_Ω p_F(u, v) dω_v, where Ω is the upper hemisphere and p_F is the SGGX phase
function of a fibre. The supplement (Eq. 1 and 2) fits P_s, because its authors knew no closed form.
docs/closed-form.md derives the closed form used here.
"""

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from integrals.fuzz.sggx import fraction_by_quadrature
from integrals.monte_carlo import Sequence, indicator, mean_estimate, unit_points
from integrals.reference import Axis, Estimate, Reference, leg
from integrals.sampling import Measure, Sampling
from shading import (
    direction,
    fiber_direction,
    fiber_normal_distribution,
    fiber_root,
    reflect,
    sin2_between,
    visible_normal,
)
from shading.fuzz.lit_cone import scattered_fraction
from shading.sine_and_cosine import sine_and_cosine
from shading.types import Scalar

ALPHA = Axis("alpha", 0.0, 1.0, "α", meaning="projected area along the fibre", open_below=True)
THETA_F = Axis("theta_f", 0.0, np.pi / 2, "θf", "rad", "polar angle of the fibre")
THETA_U = Axis("theta_u", 0.0, np.pi / 2, "θu", "rad", "polar angle of the light")
PHI = Axis(
    "phi",
    -2 * np.pi,
    2 * np.pi,
    "φ",
    "rad",
    "azimuth of the light relative to the fibre",
    period=2 * np.pi,
)
AXES = (ALPHA, THETA_F, THETA_U, PHI)

# A smaller α has no effect on P_s at any angles that float64 can represent, and α⁶ would underflow.
LEAST_ALPHA = 1e-50


@leg(*AXES)
def closed_form(alpha, theta_f, theta_u, phi) -> Estimate:
    """Evaluate the closed form. Its rounding error is at most 4ε/α, with ε of float64."""
    value = fraction_at(alpha, theta_f, theta_u, phi)
    return Estimate(value, 4 * np.finfo(float).eps / alpha)


def fraction_at(alpha: Scalar, theta_f: Scalar, theta_u: Scalar, phi: Scalar) -> Array:
    """Return P_s in closed form from α and the angles θf, θu, φ in radians, for float64.

    The leg and all fits use it. `quick_fraction_at` is for many points that no table depends on.
    """
    light, fiber = direction(theta_u, phi), fiber_direction(theta_f)
    return scattered_fraction(
        light[2],
        light @ fiber,
        fiber[2],
        alpha,
        sin2_ut=sin2_between(theta_u, theta_f, phi),
        sin2_nt=jnp.sin(theta_f) ** 2,
        least_alpha=LEAST_ALPHA,
    )


def quick_fraction_at(alpha: Scalar, theta_f: Scalar, theta_u: Scalar, phi: Scalar) -> Array:
    """Return P_s at a point, as `fraction_at`, but about six times as fast under `jax.vmap`.

    Its sines and cosines are polynomials, which the compiler vectorises. Its error is at most 4ε/α
    too, but its last digits differ. Use it for many points, such as pictures and measurements. What
    a table is made of uses `fraction_at`: with other digits, the bytes of tables would change.
    """
    theta_f, theta_u, phi = map(jnp.asarray, (theta_f, theta_u, phi))
    sin_f, cos_f = sine_and_cosine(theta_f)
    sin_u, cos_u = sine_and_cosine(theta_u)
    sin_half, cos_half = sine_and_cosine(phi / 2)
    sines = sin_u * sin_f
    # As `sin2_between` has it: full relative precision where the light is along the fibre.
    less = sine_and_cosine((theta_u - theta_f) / 2)[0] ** 2 + sines * sin_half**2
    more = sine_and_cosine((theta_u + theta_f) / 2)[1] ** 2 + sines * cos_half**2
    return scattered_fraction(
        cos_u,
        sines * ((cos_half - sin_half) * (cos_half + sin_half)) + cos_u * cos_f,
        cos_f,
        alpha,
        sin2_ut=4 * less * more,
        sin2_nt=sin_f**2,
        least_alpha=LEAST_ALPHA,
    )


@leg(*AXES)
def quadrature(alpha, theta_f, theta_u, phi, *, nodes: int = 256) -> Estimate:
    """Integrate the definition by a product rule with `nodes`² points.

    The error combines the difference to the rule with (¾ nodes)² points, and a bound on what the
    rule may miss where the nodes do not resolve α.
    """
    fiber = fiber_direction(theta_f)
    sin2_ut = sin2_between(theta_u, theta_f, phi)
    sigma_u = jnp.sqrt(sin2_ut + alpha**2 * (1 - sin2_ut))
    return fraction_by_quadrature(
        lambda h: fiber_normal_distribution(h @ fiber, alpha), sigma_u, theta_u, phi, alpha, nodes
    )


@leg(*AXES)
def monte_carlo(
    alpha,
    theta_f,
    theta_u,
    phi,
    *,
    samples: int = 1 << 16,
    sequence: Sequence = "random",
    seed: int = 0,
) -> Estimate:
    """Draw visible normals, reflect the light, and count what goes down. Not differentiable."""
    root, light = fiber_root(fiber_direction(theta_f), alpha), direction(theta_u, phi)
    points = unit_points(samples, 2, sequence, seed)

    def goes_down(point):
        return indicator(-reflect(light, visible_normal(root, light, point))[2])

    return mean_estimate(jax.vmap(jax.vmap(goes_down))(points))


# P_s changes rapidly where the light is within this many α, in radians, of the fibre.
_RING = 5.0


def _near_fibre(points: np.ndarray) -> np.ndarray:
    """Move the light of each point (α, θf, θu, φ) to within `_RING` α of the fibre.

    A light that would be below the horizon is put on it.
    """
    alpha, theta_f, theta_u, phi = points.T
    distance = _RING * alpha * (theta_u / (np.pi / 2)) ** 1.5
    fibre = np.stack([np.sin(theta_f), 0 * theta_f, np.cos(theta_f)])
    across = np.stack([np.cos(theta_f), 0 * theta_f, -np.sin(theta_f)])
    side = np.array([0.0, 1.0, 0.0])[:, None]
    around = np.cos(phi) * across + np.sin(phi) * side
    x, y, z = np.cos(distance) * fibre + np.sin(distance) * around
    theta = np.arctan2(np.hypot(x, y), np.maximum(z, 0))
    return np.stack([alpha, theta_f, np.minimum(theta, np.pi / 2), np.arctan2(y, x)], axis=1)


def _sine(points: np.ndarray) -> np.ndarray:
    _, _, theta_u, _ = points.T
    return np.sin(theta_u)


def _cosine(points: np.ndarray) -> np.ndarray:
    _, _, theta_u, _ = points.T
    return np.cos(theta_u)


# A least-squares fit weights light directions uniformly in the angles, by solid angle, or by
# projected solid angle ('cosine'). A fit of the largest error multiplies it by cos θu for 'cosine',
# which gives the error of the light that arrives, and leaves it as it is for the others.
MEASURES = {
    "uniform": Measure(),
    "solid-angle": Measure(density=_sine),
    "cosine": Measure(density=lambda points: _sine(points) * _cosine(points), largest=_cosine),
}

PS = Reference(
    name="ps",
    symbol="P_s",
    meaning="fraction of light that the fibre layer scatters towards the base",
    definition="1 − ∫_Ω p_F(u, v) dω_v",
    axes=AXES,
    sampling=Sampling(fitted=13, checked=15, judged=17, extra=_near_fibre, measures=MEASURES),
    closed_form=closed_form,
    quadrature=quadrature,
    monte_carlo=monte_carlo,
)
