"""Exact radiances of the fuzz BRDF and those of its ambient model, for many materials and views.

Fibres and base are white, so that a radiance is a fraction of the light. The exact radiance is a
quadrature of the whole BRDF. The model is evaluated with exact P_s, G, Q and R, which shows the
error of its own approximations, and with every set of tables.
"""

from dataclasses import dataclass
from itertools import product

import jax
import jax.numpy as jnp
import numpy as np

from integrals.fuzz.radiance import base_response, layer_response, phase_over_lights
from shadefit.ambient.lights import lights
from shadefit.render.functions import EXACT, Functions, table_sets
from shading import (
    ambient_attenuation,
    ambient_layer,
    direction_cosines,
    escape,
    irradiance,
    mean_radiance,
    roughness_from_spread,
)

# What `materials_and_views` combines; TILTS and AZIMUTHS (of the view) are in degrees.
DENSITIES = (0.1, 0.2, 0.5)
SPREADS = (0.05, 0.2, 0.5, 1.0)
TILTS = (0.0, 23.0, 45.0, 90.0)
COSINES = (0.1, 0.2, 0.35, 0.5, 0.7, 0.85, 1.0)
AZIMUTHS = (0.0, 45.0, 90.0, 135.0, 180.0)
# The rule for integrals over the hemisphere: its error is below 1e-4 for the materials above
# (tests/shadefit/test_ambient.py).
HEMISPHERE_RULE = {"step": 1 / 10, "azimuths": 96}
_NORMAL = np.array([0.0, 0.0, 1.0])
# Points that are integrated at once.
_BATCH = 32


@dataclass(frozen=True)
class Radiances:
    """Radiances of layer and base at n points in several lights.

    * `points` (n, 5): α, θf, d, θv and φv of each material and view; angles in radians.
    * `lights`: the names of the lights.
    * `exact`: the exact radiances (n, lights) of 'layer' and 'base'.
    * `models`: the same by the ambient model, for each set of functions by its name.
    """

    points: np.ndarray
    lights: tuple[str, ...]
    exact: dict[str, np.ndarray]
    models: dict[str, dict[str, np.ndarray]]


def phase_integrals(at: np.ndarray) -> np.ndarray:
    """Return ∫_Ω p(u, v) dω_u (n,) at points (n, 5). The model uses 1 − P_s(v) in its place."""
    materials, which = np.unique(at[:, [0, 1, 3, 4]], axis=0, return_inverse=True)
    return np.asarray(_phase_batches(jnp.asarray(materials)))[which]


@jax.jit
def _phase_batches(at):
    return jax.lax.map(lambda x: phase_over_lights(*x, **HEMISPHERE_RULE), at, batch_size=_BATCH)


def materials_and_views() -> np.ndarray:
    """Return all combinations of material and view (n, 5): α, θf, d, θv, φv; angles in radians."""
    every = product(SPREADS, TILTS, DENSITIES, COSINES, AZIMUTHS)
    rows = [
        (roughness_from_spread(s), np.radians(t), d, np.arccos(c), np.radians(a))
        for s, t, d, c, a in every
    ]
    return np.array(rows, float)


def radiances(at: np.ndarray, sets: tuple[Functions, ...] = ()) -> Radiances:
    """Return the exact radiances and the model's at points (n, 5), in all lights.

    `sets` are the functions that the model is evaluated with; by default the exact ones and every
    set of tables.
    """
    every = lights()
    harmonic = np.stack(list(every.values()), axis=1)
    materials, which = np.unique(at[:, :3], axis=0, return_inverse=True)
    layer = layer_responses(at) @ harmonic
    reaching = (_bases(materials) @ harmonic / np.pi)[which]
    exact = {"layer": layer, "base": _escaping(at)[:, None] * reaching}
    models = {each.name: _model(each, at, harmonic) for each in sets or (EXACT, *table_sets())}
    return Radiances(at, tuple(every), exact, models)


@jax.jit
def _layer_batches(at):
    return jax.lax.map(lambda x: layer_response(*x, **HEMISPHERE_RULE), at, batch_size=_BATCH)


def layer_responses(at: np.ndarray) -> np.ndarray:
    """Return the exact weights (n, 9) of the nine harmonics of a light at points (n, 5)."""
    return np.asarray(_layer_batches(jnp.asarray(at)))


@jax.jit
def _base_batches(materials):
    def both(x):
        unscattered, scattered = base_response(*x, **HEMISPHERE_RULE)
        return unscattered + scattered

    return jax.lax.map(both, materials, batch_size=_BATCH)


def _bases(materials: np.ndarray) -> np.ndarray:
    return np.asarray(_base_batches(jnp.asarray(materials)))


def _escaping(at: np.ndarray) -> np.ndarray:
    return np.asarray(jax.vmap(escape)(np.cos(at[:, 3]), at[:, 2]))


def _model(functions: Functions, at: np.ndarray, harmonic: np.ndarray) -> dict[str, np.ndarray]:
    """Return the ambient model's radiances (n, lights) of 'layer' and 'base'."""
    mean = mean_radiance(harmonic, _NORMAL)
    received = irradiance(harmonic, _NORMAL)

    def one(alpha, theta_f, density, theta_v, phi):
        cos_v, cos_vt = direction_cosines(theta_f, theta_v, jnp.cos(phi))
        down = functions.ps(cos_v, cos_vt, jnp.cos(theta_f), alpha, theta_f)
        layer = ambient_layer(mean, 1.0, functions.g(density, cos_v), down)
        return layer, (cos_v, density, functions.q(density))

    layer, (cos_v, density, q) = jax.jit(jax.vmap(one))(*at.T)
    materials, which = np.unique(at[:, :2], axis=0, return_inverse=True)
    r = jax.jit(lambda x: jax.lax.map(lambda m: functions.r(*m), x))(materials)[which]
    shadow = jax.vmap(ambient_attenuation, (0, 0, None, 0, 0))(cos_v, density, 1.0, q, r)
    return {"layer": np.asarray(layer), "base": np.asarray(shadow[:, None] * received / np.pi)}


def named_place(point: np.ndarray) -> dict[str, float]:
    """Return a point (5,) as spread, tilt, density, v·n and azimuth by name; angles in degrees."""
    alpha, theta_f, density, theta_v, phi = (float(x) for x in point)
    return {
        "spread": round(alpha**2, 6),
        "tilt": round(float(np.degrees(theta_f)), 6),
        "density": density,
        "cos_v": round(float(np.cos(theta_v)), 6),
        "azimuth": round(float(np.degrees(phi)), 6),
    }
