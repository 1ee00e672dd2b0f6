"""The ambient model of the fuzz BRDF against the integral that it stands for.

White fibres over a white base, so that every figure is a fraction of the light. The exact radiance
is a quadrature of the whole BRDF; the model is tried with exact G, Q, R and P_s, which leaves the
error of its approximations, and with every set of tables.
"""

from dataclasses import dataclass
from itertools import product

import jax
import jax.numpy as jnp
import numpy as np

from integrals import PS
from integrals.fuzz.radiance import (
    base_response,
    layer_response,
    phase_over_lights,
)
from shadefit.render.functions import functions, table_sets
from shading import (
    ambient_attenuation,
    ambient_layer,
    direction_cosines,
    escape,
    harmonics,
    irradiance,
    mean_radiance,
    roughness_from_spread,
)

DENSITIES = (0.1, 0.2, 0.5)
SPREADS = (0.05, 0.2, 0.5, 1.0)
TILTS = (0.0, 23.0, 45.0, 90.0)
COSINES = (0.1, 0.2, 0.35, 0.5, 0.7, 0.85, 1.0)
AZIMUTHS = (0.0, 45.0, 90.0, 135.0, 180.0)
# This rule of the hemisphere is good to 1e-4 for the materials above (tests/test_ambient.py).
RULE = {"step": 1 / 10, "azimuths": 96}
PARTS = ("layer", "base")
_NORMAL = np.array([0.0, 0.0, 1.0])
_BATCH = 32


@dataclass(frozen=True)
class Radiances:
    """Radiance of layer and base over the points (n, 5) of (α, θf, d, θv, φv), light by light.

    `exact` and each of `models` map 'layer' and 'base' to (n, lights).
    """

    points: np.ndarray
    lights: tuple[str, ...]
    exact: dict[str, np.ndarray]
    models: dict[str, dict[str, np.ndarray]]


def lit_phase(at: np.ndarray) -> np.ndarray:
    """Give ∫_Ω p(u, v) dω_u (n,) at points (n, 5): what 1 − P_s(v) stands for in the model."""
    materials, which = np.unique(at[:, [0, 1, 3, 4]], axis=0, return_inverse=True)
    return np.asarray(_lit_batches(jnp.asarray(materials)))[which]


@jax.jit
def _lit_batches(at):
    return jax.lax.map(lambda x: phase_over_lights(*x, **RULE), at, batch_size=_BATCH)


def lights() -> dict[str, np.ndarray]:
    """Give lights as nine harmonics each: uniform, and broad lobes ((1 + ω·s)/2)² about s.

    Such a lobe is of second order exactly, and nowhere negative. The fibre leans to azimuth 0.
    """
    about = {
        "from above": (0.0, 0.0, 1.0),
        "where fibres point": (1.0, 0.0, 0.0),
        "from the side": (0.0, 1.0, 0.0),
        "against fibres": (-1.0, 0.0, 0.0),
    }
    uniform = np.zeros(9)
    uniform[0] = np.sqrt(4 * np.pi)
    return {"uniform": uniform, **{name: _lobe(np.array(s)) for name, s in about.items()}}


def _lobe(axis: np.ndarray) -> np.ndarray:
    """Give the harmonics of ((1 + ω·s)/2)² = 1/3 + (ω·s)/2 + P₂(ω·s)/6 by the addition theorem."""
    legendre = np.repeat([1 / 3, 1 / 2, 1 / 6], [1, 3, 5])
    bands = np.repeat([1.0, 3.0, 5.0], [1, 3, 5])
    return legendre * 4 * np.pi / bands * np.asarray(harmonics(axis))


def points() -> np.ndarray:
    """Give every material and view (n, 5): α, θf, d, θv, φv, angles in radians."""
    every = product(SPREADS, TILTS, DENSITIES, COSINES, AZIMUTHS)
    rows = [
        (roughness_from_spread(s), np.radians(t), d, np.arccos(c), np.radians(a))
        for s, t, d, c, a in every
    ]
    return np.array(rows, float)


def radiances(at: np.ndarray, names: tuple[str, ...] = ()) -> Radiances:
    """Evaluate the exact radiances and the model's at points (n, 5), in all lights.

    `names` are the sets of functions that the model is tried with; by default exact and all tables.
    """
    every = lights()
    harmonic = np.stack(list(every.values()), axis=1)
    materials, which = np.unique(at[:, :3], axis=0, return_inverse=True)
    layer = _layers(at) @ harmonic
    reaching = (_bases(materials) @ harmonic / np.pi)[which]
    exact = {"layer": layer, "base": _escaping(at)[:, None] * reaching}
    models = {name: _model(name, at, harmonic) for name in names or ("exact", *table_sets())}
    return Radiances(at, tuple(every), exact, models)


@jax.jit
def _layer_batches(at):
    return jax.lax.map(lambda x: layer_response(*x, **RULE), at, batch_size=_BATCH)


def _layers(at: np.ndarray) -> np.ndarray:
    return np.asarray(_layer_batches(jnp.asarray(at)))


@jax.jit
def _base_batches(materials):
    def both(x):
        unscattered, scattered = base_response(*x, **RULE)
        return unscattered + scattered

    return jax.lax.map(both, materials, batch_size=_BATCH)


def _bases(materials: np.ndarray) -> np.ndarray:
    return np.asarray(_base_batches(jnp.asarray(materials)))


def _escaping(at: np.ndarray) -> np.ndarray:
    return np.asarray(jax.vmap(escape)(np.cos(at[:, 3]), at[:, 2]))


def _model(name: str, at: np.ndarray, harmonic: np.ndarray) -> dict[str, np.ndarray]:
    """Give the ambient model's radiances with the functions of that name, (n, lights) each."""
    chosen = functions(name)
    mean = mean_radiance(harmonic, _NORMAL)
    received = irradiance(harmonic, _NORMAL)

    def one(alpha, theta_f, density, theta_v, phi):
        cos_v, cos_vt = direction_cosines(theta_f, theta_v, jnp.cos(phi))
        down = chosen.ps(cos_v, cos_vt, jnp.cos(theta_f), alpha, theta_f)
        layer = ambient_layer(mean, 1.0, chosen.g(density, cos_v), down)
        return layer, (cos_v, density, chosen.q(density))

    layer, (cos_v, density, q) = jax.jit(jax.vmap(one))(*at.T)
    materials, which = np.unique(at[:, :2], axis=0, return_inverse=True)
    r = jax.jit(lambda x: jax.lax.map(lambda m: chosen.r(*m), x))(materials)[which]
    shadow = jax.vmap(ambient_attenuation, (0, 0, None, 0, 0))(cos_v, density, 1.0, q, r)
    return {"layer": np.asarray(layer), "base": np.asarray(shadow[:, None] * received / np.pi)}


def without_symmetry(found: Radiances) -> dict[str, float]:
    """Give the layer's relative rms error, light by light, with ∫ p(u, v) dω_u for 1 − P_s(v).

    Exact functions otherwise: what is left is the product of averages for the average product.
    """
    alpha, theta_f, _, theta_v, phi = found.points.T
    down = jax.jit(jax.vmap(PS.value))(alpha, theta_f, theta_v, phi)
    factor = lit_phase(found.points) / (1 - np.asarray(down))
    off = found.models["exact"]["layer"] * factor[:, None] - found.exact["layer"]
    relative = np.sqrt(np.mean(off**2, axis=0)) / found.exact["layer"].mean(axis=0)
    return {light: float(x) for light, x in zip(found.lights, relative, strict=True)}


def errors(found: Radiances) -> list[dict]:
    """Sum up, light by light: relative rms error of the model with each set of functions.

    Relative to the mean exact radiance of that part in that light. `worst` is the largest error of
    the model with the first functions, relative likewise, and `where` the point.
    """
    rows = []
    for part, (i, light) in product(PARTS, enumerate(found.lights)):
        exact = found.exact[part][:, i]
        mean = float(exact.mean())
        off = {name: model[part][:, i] - exact for name, model in found.models.items()}
        first = next(iter(off.values()))
        worst = int(np.argmax(np.abs(first)))
        rows.append(
            {
                "part": part,
                "light": light,
                "mean": mean,
                "rms": {k: float(np.sqrt(np.mean(v**2)) / mean) for k, v in off.items()},
                "bias": {k: float(v.mean() / mean) for k, v in off.items()},
                "worst": float(first[worst] / mean),
                "where": place_of(found.points[worst]),
            }
        )
    return rows


def place_of(point: np.ndarray) -> dict[str, float]:
    """Name a point's coordinates as the command line does: spread, tilt and azimuth in degrees."""
    alpha, theta_f, density, theta_v, phi = (float(x) for x in point)
    return {
        "spread": round(alpha**2, 6),
        "tilt": round(float(np.degrees(theta_f)), 6),
        "density": density,
        "cos_v": round(float(np.cos(theta_v)), 6),
        "azimuth": round(float(np.degrees(phi)), 6),
    }
