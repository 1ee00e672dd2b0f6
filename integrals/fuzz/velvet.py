"""r(k), the largest factor that lets the velvet phase function create no energy.

r(k) = 1 / max_u ∫ p_Schlick(k, −sin(t, h)) dω_v over the sphere of v. For k ≤ 0 the maximum is at
u·t = 0, and there the integral is elementary; docs/brdf.md proves both.
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
    "asymmetry", "k", "1", -1.0, 0.0, "asymmetry of Schlick's lobe", open_below=True, alias="k"
)
AXES = (ASYMMETRY,)

# The closed form cancels as k → 0; below this |k| the power series takes over.
_SERIES_LIMIT = 0.25
_SERIES_TERMS = 30
_EPS = float(np.finfo(float).eps)


def series_coefficients(count: int) -> np.ndarray:
    """Give a₀ … of ∫ p dω_v = (1 − x²) Σ aₙ xⁿ at u·t = 0, x = −k: all are positive.

    aₙ = (2/π) (n + 1) ∫₀^π sinⁿ⁺² η dη.
    """
    sines = np.empty(count + 2)
    sines[0], sines[1] = np.pi, 2.0
    for m in range(2, count + 2):
        sines[m] = (m - 1) / m * sines[m - 2]
    return 2 / np.pi * np.arange(1, count + 1) * sines[2:]


def normalisation(asymmetry: Scalar) -> Array:
    """Give r(k) in closed form for k in (−1, 0].

    r = (π/2) x² s / (A (2x² − 1) + 2xs + πs³) with x = −k, s = √(1 − x²), A = π + 2 arcsin x.
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
    """Give ∫ p_Schlick(k, −sin(t, h)) dω_v over the sphere for any light, by quadrature.

    `asymmetry` k in (−1, 0]; `cos_ut` = u·t in [−1, 1]. With dω_v = 4 (u·h) dω_h it is the mean of
    |u·h| over circles about t, elementary, integrated over their angle η from t by `nodes` Gauss
    points on either side of η = π/2 − arccos|u·t|, where a circle begins to dip below u's horizon.
    """
    k, cosine = jnp.asarray(asymmetry), jnp.abs(jnp.asarray(cos_ut))
    y, weights = gauss_legendre(nodes, 0.0, 1.0)
    edge = jnp.arcsin(cosine)
    # Squares, because the mean has an edge in the power 3/2 there.
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
    """Evaluate the closed form."""
    value = normalisation(asymmetry)
    return Estimate(value, 64 * _EPS * value)


@leg(*AXES)
def quadrature(asymmetry, *, nodes: int = 64) -> Estimate:
    """Integrate the lobe over h at u·t = 0 by nodes² points: dω_v = 4 (u·h) dω_h.

    About the circle h ⟂ t the lobe is a ridge. Its angle y off that circle is taken for a true
    anomaly and its eccentric one z for the variable: tan(y/2) = √((1 − x)/(1 + x)) tan(z/2).
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
    # 1 − x sin(t, h) is a difference of two numbers near one.
    return Estimate(value, error + 8 * _EPS / (1 + asymmetry) * value)


@leg(*AXES)
def monte_carlo(
    asymmetry, *, samples: int = 1 << 16, sequence: Sequence = "random", seed: int = 0
) -> Estimate:
    """Average the lobe over v drawn uniformly from the sphere, at u·t = 0.

    The standard error speaks of what the samples see: 1 + k well above 1/samples.
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
