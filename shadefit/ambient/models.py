"""The models of the layer in ambient light at many materials and views, with any G and P_s.

The materials and views are those of `radiances`. No constant of a model was fitted to them.
"""

import functools

import jax
import jax.numpy as jnp
import numpy as np

import integrals
from coefficients.ambient import part_costs, tables
from coefficients.catalogue import resolve
from shadefit.ambient.lights import lights
from shadefit.ambient.radiances import Radiances
from shading import (
    AMBIENT_MODELS,
    LayerView,
    direction,
    direction_cosines,
    fiber_direction,
    light_weights,
)
from shading.fuzz.lit_cone import scattered_fraction

EXACT = "exact"
CLOSED = "closed form"
# P_s and G that models are compared with. The second pair is that of the exported functions.
EXPORTED = (CLOSED, tables.G)
CHOICES = (
    (EXACT, EXACT),
    EXPORTED,
    ("best/ps-36-wide", "best/g-17"),
    ("best/ps-25", "best/g-9"),
    ("best/ps-11", "best/g-9"),
    ("published/ps", "published/g"),
)
# More of G for the recommended model, which has a P_s of its own
OTHER_G = tuple((CLOSED, name) for name in ("best/g-10", "best/g-9", "published/g"))
_NORMAL = np.array([0.0, 0.0, 1.0])


def views(at: np.ndarray, scattered: str = EXACT, scattering: str = EXACT) -> LayerView:
    """Return what models read at points (n, 5), as arrays (n,).

    `scattered` and `scattering` say which P_s and G: the names of tables, 'exact', or for P_s also
    'closed form', that of exported code. The points are those of `Radiances`.
    """
    alpha, theta_f, density, theta_v, phi = at.T
    cos_v, cos_vt = jax.vmap(direction_cosines)(theta_f, theta_v, np.cos(phi))
    cos_nt = np.cos(theta_f)
    g = jax.jit(jax.vmap(_scattering(scattering)))(density, cos_v)
    p = jax.jit(jax.vmap(_scattered(scattered)))(cos_v, cos_vt, cos_nt, alpha, theta_f)
    return LayerView(*map(np.asarray, (cos_v, cos_vt, cos_nt, alpha, density, g, p)))


def _scattering(name: str):
    if name == EXACT:
        return integrals.G.value
    (table,) = resolve(name).functions("double")
    return lambda density, cos_v: table.call(cos_v, density)


def _scattered(name: str):
    if name == EXACT:
        return lambda cos_v, cos_vt, cos_nt, alpha, _: scattered_fraction(
            cos_v, cos_vt, cos_nt, alpha
        )
    if name == CLOSED:
        return lambda *point: tables.scattered(*point[:-1])
    material, along = resolve(name).functions("double")
    return lambda cos_v, cos_vt, _, alpha, theta_f: along.call(
        material.call(alpha, theta_f), cos_v, cos_vt
    )


@functools.cache
def _compiled(model: str):
    def weights(view, theta_f, theta_v, phi):
        light = AMBIENT_MODELS[model](view)
        vectors = direction(theta_v, phi), fiber_direction(theta_f)
        return light_weights(light, jnp.asarray(_NORMAL), *vectors)

    return jax.jit(jax.vmap(weights))


def model_weights(model: str, view: LayerView, at: np.ndarray) -> np.ndarray:
    """Return the weights (n, 9) of the nine harmonics by a model, at points (n, 5)."""
    return np.asarray(_compiled(model)(view, at[:, 1], at[:, 3], at[:, 4]))


def model_rows(found: Radiances) -> list[dict]:
    """Return a row for each model with exact P_s and G and with those of exported code.

    The model 'cheap' has a row for each of `CHOICES`, and 'recommended' one for each of `OTHER_G`.
    Errors are those of the layer, relative to its mean exact radiance, by the names of the lights.
    `brightest` and `least` are the largest radiance in uniform light of radiance one and the least
    one in all lights. `operations` are those of the exported function by its parts.
    """
    harmonic = np.stack(list(lights().values()), axis=1)
    exact = found.exact["layer"]
    uniform = found.lights.index("uniform")
    pairs = {"cheap": CHOICES, "recommended": (*CHOICES[:2], *OTHER_G)}
    seen = {pair: views(found.points, *pair) for pair in (*CHOICES, *OTHER_G)}
    costs = {name: part_costs(name) for name in AMBIENT_MODELS}
    rows = []
    for name, model in AMBIENT_MODELS.items():
        for pair in pairs.get(name, CHOICES[:2]):
            radiance = model_weights(name, seen[pair], found.points) @ harmonic
            error = (radiance - exact) / exact.mean(axis=0)
            rms, largest = np.sqrt(np.mean(error**2, axis=0)), np.abs(error).max(axis=0)
            rows.append(
                {
                    "model": name,
                    "meaning": model.meaning,
                    "scattered": pair[0],
                    "scattering": pair[1],
                    "rms": dict(zip(found.lights, rms.tolist(), strict=True)),
                    "largest": dict(zip(found.lights, largest.tolist(), strict=True)),
                    "brightest": float(radiance[:, uniform].max()),
                    "least": float(radiance.min()),
                    "operations": costs[name],
                }
            )
    return rows
