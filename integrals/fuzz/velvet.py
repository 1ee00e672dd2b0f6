"""r(k), the largest normalisation with which the velvet phase function creates no energy.

r(k) = 1 / max_u ∫ p_Schlick(k, −sin(t, h)) dω_v, an integral over the sphere of v. For k ≤ 0 the
maximum is at u·t = 0, and the integral there is elementary. docs/brdf.md proves both. All legs
evaluate the integral at u·t = 0. `scattered_energy` evaluates it for any light.
"""

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from integrals.monte_carlo import Sequence, mean_estimate, unit_points
from integrals.reference import Axis, Estimate, Reference, leg
from integrals.rules.interval import checked_rule, gauss_legendre
from integrals.sampling import Sampling
from shading import direction, half_vector, velvet_lobe
from shading.types import Scalar

ASYMMETRY = Axis(
    "asymmetry", -1.0, 0.0, "k", meaning="asymmetry of Schlick's lobe", open_below=True, alias="k"
)
AXES = (ASYMMETRY,)

# The closed form loses digits by cancellation as k → 0. A power series is used for smaller |k|.
_SERIES_LIMIT = 0.25
_SERIES_TERMS = 30
_EPS = float(np.finfo(float).eps)


def series_coefficients(count: int) -> np.ndarray:
    """Return a₀, a₁, … of ∫ p dω_v = (1 − x²) Σ aₙ xⁿ at u·t = 0, where x = −k.

    aₙ = (2/π) (n + 1) ∫₀^π sinⁿ⁺² η dη. All are positive. `count` is how many are returned.
    """
    sines = np.empty(count + 2)
    sines[0], sines[1] = np.pi, 2.0
    for m in range(2, count + 2):
        sines[m] = (m - 1) / m * sines[m - 2]
    return 2 / np.pi * np.arange(1, count + 1) * sines[2:]


def normalisation(asymmetry: Scalar) -> Array:
    """Return r(k) in closed form for k in (−1, 0].

    r = (π/2) x² s / (A (2x² − 1) + 2xs + πs³), where x = −k, s = √(1 − x²) and A = π + 2 arcsin x.
    """
    # notation: x, s, A as above
    x = -jnp.asarray(asymmetry)
    series = x < _SERIES_LIMIT
    small, large = jnp.where(series, x, 0.0), jnp.where(series, 0.5, x)
    total = jnp.zeros_like(small)
    for coefficient in series_coefficients(_SERIES_TERMS)[::-1]:
        total = coefficient + small * total
    s2 = (1 - large) * (1 + large)
    s, a = jnp.sqrt(s2), np.pi + 2 * jnp.arcsin(large)
    bracket = a * (2 * large * large - 1) + 2 * large * s + np.pi * s * s2
    plain = (np.pi / 2) * large * large * s / bracket
    return jnp.where(series, 1 / ((1 - small) * (1 + small) * total), plain)


def scattered_energy(asymmetry: Scalar, cos_ut: Scalar, nodes: int = 96) -> Array:
    """Return ∫ p_Schlick(k, −sin(t, h)) dω_v over the sphere of v for any light, by quadrature.

    `asymmetry` is k in (−1, 0] and `cos_ut` is u·t in [−1, 1]. With dω_v = 4 (u·h) dω_h the
    integral becomes one over h. The integral of |u·h| over a circle of h at the angle η from t is
    elementary. It is then integrated over η by `nodes` Gauss points on each side of
    η = π/2 − arccos|u·t|. Circles with a larger η are partly below the horizon of u.
    """
    k, cosine = jnp.asarray(asymmetry), jnp.abs(jnp.asarray(cos_ut))
    y, weights = gauss_legendre(nodes, 0.0, 1.0)
    edge = jnp.arcsin(cosine)
    # Near the edge the integrand contains (η − edge)^(3/2). The substitution of y² makes it smooth.
    below, above = edge * (1 - y * y), edge + (np.pi / 2 - edge) * y * y
    etas = jnp.concatenate([below, above])
    weights = jnp.concatenate([edge * 2 * y * weights, (np.pi / 2 - edge) * 2 * y * weights])
    across = jnp.sin(etas) * jnp.sqrt((1 - cosine) * (1 + cosine))
    along = jnp.cos(etas) * cosine
    dips = along < across
    ratio = jnp.where(dips, along / jnp.where(dips, across, 1.0), 0.0)
    part = across * jnp.sqrt((1 - ratio) * (1 + ratio)) + along * jnp.arcsin(ratio)
    circle = jnp.where(dips, 4 * part, 2 * np.pi * along)
    sines = jnp.sin(etas)
    lobe = (1 - k) * (1 + k) / (4 * np.pi * (1 + k * sines) ** 2)
    return 4 * jnp.sum(weights * sines * lobe * circle)


@leg(*AXES)
def closed_form(asymmetry) -> Estimate:
    """Evaluate the closed form. Its relative error is at most 64ε, with ε of float64."""
    value = normalisation(asymmetry)
    return Estimate(value, 64 * _EPS * value)


@leg(*AXES)
def quadrature(asymmetry, *, nodes: int = 64) -> Estimate:
    """Integrate the lobe over h at u·t = 0 by `nodes`² points, with dω_v = 4 (u·h) dω_h.

    As k → −1 the lobe becomes a narrow ridge about the circle h ⟂ t. Let y be the angle between h
    and that circle. The rule integrates over z, with tan(y/2) = √((1 − x)/(1 + x)) tan(z/2) and
    x = −k. The ridge is wide in z.
    """
    x = -asymmetry
    squeeze = jnp.sqrt((1 - x) / (1 + x))

    def rule(count: int) -> Array:
        unit, weights = gauss_legendre(count, 0.0, 1.0)
        psi, psi_weights = unit * np.pi / 2, weights * np.pi / 2
        z = unit * 2 * jnp.arctan(1 / squeeze)
        y = 2 * jnp.arctan(squeeze * jnp.tan(z / 2))
        slope = jnp.sqrt((1 - x) * (1 + x)) / (1 + x * jnp.cos(z))
        lobe = jax.vmap(velvet_lobe, (None, 0))(asymmetry, jnp.sin(y)) * jnp.cos(y) ** 2
        over_y = jnp.sum(weights * 2 * jnp.arctan(1 / squeeze) * slope * lobe)
        return 1 / (16 * over_y * jnp.sum(psi_weights * jnp.cos(psi)))

    value, error = checked_rule(rule, nodes, 1e-15)
    # Rounding: as k → −1, 1 − x sin(t, h) in the lobe is a difference of two numbers near one.
    return Estimate(value, error + 8 * _EPS / (1 + asymmetry) * value)


@leg(*AXES)
def monte_carlo(
    asymmetry, *, samples: int = 1 << 16, sequence: Sequence = "random", seed: int = 0
) -> Estimate:
    """Average the lobe over views v that are uniform over the sphere, for light with u·t = 0.

    The standard error is reliable only if 1 + k is much larger than 1/samples. Otherwise too few
    samples fall on the ridge of the lobe.
    """
    fiber, light = direction(0.0, 0.0), jnp.array([1.0, 0.0, 0.0])

    def lobe(point):
        view = direction(jnp.arccos(1 - 2 * point[0]), 2 * jnp.pi * point[1])
        return 4 * jnp.pi * velvet_lobe(asymmetry, half_vector(light, view) @ fiber)

    mean, error = mean_estimate(jax.vmap(jax.vmap(lobe))(unit_points(samples, 2, sequence, seed)))
    return Estimate(1 / mean, error / mean**2)


VELVET = Reference(
    name="velvet",
    symbol="r",
    meaning="largest factor of the velvet phase function that creates no energy",
    definition="1 / max_u ∫ p_Schlick(k, −sin(t, h)) dω_v",
    axes=AXES,
    sampling=Sampling(fitted=11, checked=13, judged=16),
    closed_form=closed_form,
    quadrature=quadrature,
    monte_carlo=monte_carlo,
)
