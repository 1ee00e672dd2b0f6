"""A cloth in a strong light of nine harmonics, exact and by two ambient models.

The light is a broad lobe and a uniform rest, which nine harmonics represent exactly. The exact
image is quadrature of the whole BRDF. The models take the tables of the exported functions.
"""

from dataclasses import dataclass

import jax
import numpy as np
from scipy.interpolate import RectBivariateSpline

from coefficients.ambient import tables
from integrals.fuzz.radiance import base_response
from shadefit.ambient.models import EXPORTED, model_weights, views
from shadefit.ambient.radiances import HEMISPHERE_RULE, layer_responses
from shadefit.render.fibers import azimuths
from shadefit.render.image import SAMPLES
from shadefit.render.scenes import SCENES, Hits
from shadefit.render.settings import Settings
from shading import ambient_attenuation, escape, harmonics, roughness_from_spread
from shading.harmonics import LOBE, UNIFORM

SETTINGS = Settings(
    density=0.3, spread=0.1, tilt=float(np.radians(55)), fiber="#8fb4ff", base="#1b2a5c", size=210
)
# The axis of the lobe ((1 + ω·s)/2)², its linear RGB, and that of the uniform light.
AXIS, KEY, REST = (0.93, 0.2, 0.31), (5.8, 5.1, 4.1), (0.2, 0.24, 0.3)
MODELS = ("talk", "recommended")
# Exact radiances are computed at these values of √(v·n) and azimuths of half a circle, and
# interpolated by bicubic splines.
_ROOTS, _HALF_CIRCLE = np.sqrt(np.linspace(0.1**2, 1, 41)), np.linspace(0, np.pi, 37)
_LEAST_COSINE = float(_ROOTS[0] ** 2)
# The harmonics with an odd power of y change their sign with the azimuth.
_ODD = (1, 4, 5)
_LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


@dataclass(frozen=True)
class Cloth:
    """Linear images (h, w, 3) of the cloth: the exact one, and one for each model by its name."""

    exact: np.ndarray
    models: dict[str, np.ndarray]

    def differences(self, name: str) -> np.ndarray:
        """Return the luminance (h, w) of a model minus the exact, over the mean exact one."""
        exact = self.exact @ _LUMINANCE
        return (self.models[name] @ _LUMINANCE - exact) / exact.mean()


def render_cloth(settings: Settings = SETTINGS) -> Cloth:
    """Render the cloth in the light by quadrature and by each of `MODELS`."""
    hits = SCENES["cloth"].hits(settings.size * SAMPLES)
    frames = _frames(hits, azimuths(settings.fibers, hits))
    material = settings.material
    view = np.einsum("nij,nj->ni", frames, hits.view)
    angles = np.stack(
        [
            np.arccos(np.clip(view[:, 2], _LEAST_COSINE, 1)),
            np.arctan2(view[:, 1], view[:, 0]),
        ],
        axis=1,
    )
    alpha = float(roughness_from_spread(material.spread))
    point = np.array([alpha, material.tilt, material.density])
    at = np.column_stack([np.tile(point, (len(angles), 1)), angles])
    light = _local_light(frames)
    fiber, base = np.array(material.fiber), np.array(material.base)

    def image(layer: np.ndarray, below: np.ndarray) -> np.ndarray:
        flat = (fiber * layer + base * below) * hits.open_sky[:, None]
        shape = (settings.size, SAMPLES, settings.size, SAMPLES, 3)
        return flat.reshape(shape).mean(axis=(1, 3))

    unscattered, scattered = map(np.asarray, base_response(*point, **HEMISPHERE_RULE))
    reaching = _seen(unscattered, light) + fiber * _seen(scattered, light)
    passing = np.asarray(jax.vmap(escape, (0, None))(np.cos(angles[:, 0]), material.density))
    exact = image(_seen(_exact_weights(point, angles), light), passing[:, None] * reaching / np.pi)
    below = _model_base(at, light, fiber)
    seen = views(at, *EXPORTED)
    models = {name: image(_seen(model_weights(name, seen, at), light), below) for name in MODELS}
    return Cloth(exact, models)


def _frames(hits: Hits, turns: np.ndarray) -> np.ndarray:
    """Return rotations (n, 3, 3) into frames with the fibre in the plane of x and z = normal."""
    across = np.cross(hits.normal, hits.comb)
    along = np.cos(turns)[:, None] * hits.comb + np.sin(turns)[:, None] * across
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-6)
    return np.stack([along, np.cross(hits.normal, along), hits.normal], axis=1)


def _local_light(frames: np.ndarray) -> np.ndarray:
    """Return the harmonics (n, 9, 3) of the light in each frame."""
    axis = np.array(AXIS) / np.linalg.norm(AXIS)
    own = LOBE * np.asarray(jax.jit(jax.vmap(harmonics))(frames @ axis))
    key = own[..., None] * np.array(KEY)
    key[:, 0] += UNIFORM[0] * np.array(REST)
    return key


def _seen(weights: np.ndarray, light: np.ndarray) -> np.ndarray:
    """Return the radiance (n, 3) of weights (n, 9) or (9,) in light (n, 9, 3)."""
    return np.maximum(
        np.einsum("...i,nic->nc" if weights.ndim == 1 else "ni,nic->nc", weights, light), 0
    )


def _exact_weights(point: np.ndarray, angles: np.ndarray) -> np.ndarray:
    """Return the exact weights (n, 9) of the layer at views (n, 2), by interpolation."""
    root, azimuth = (a.ravel() for a in np.meshgrid(_ROOTS, _HALF_CIRCLE, indexing="ij"))
    nodes = np.column_stack([np.tile(point, (len(root), 1)), np.arccos(root**2), azimuth])
    table = layer_responses(nodes).reshape(len(_ROOTS), len(_HALF_CIRCLE), 9)
    where = np.sqrt(np.cos(angles[:, 0])), np.abs(angles[:, 1])
    found = [
        RectBivariateSpline(_ROOTS, _HALF_CIRCLE, table[..., i])(*where, grid=False)
        for i in range(9)
    ]
    signs = np.where(angles[:, 1] < 0, -1.0, 1.0)
    return np.stack([x * signs if i in _ODD else x for i, x in enumerate(found)], axis=1)


def _model_base(at: np.ndarray, light: np.ndarray, fiber: np.ndarray) -> np.ndarray:
    """Return the radiance (n, 3) of a white base by the ambient model, c_atten E/π."""
    alpha, tilt, density = at[0, :3]
    q = float(tables.average_penetration(density))
    r = float(tables.average_scattered(alpha, np.cos(tilt)))
    down = np.asarray(
        jax.vmap(ambient_attenuation, (0, None, None, None, None))(
            np.cos(at[:, 3]), density, 1.0, q, r
        )
    )
    bands = np.repeat([np.pi, 2 * np.pi / 3, np.pi / 4], [1, 3, 5])
    received = _seen(bands * np.asarray(harmonics(np.array([0.0, 0.0, 1.0]))), light)
    colour = (q + fiber * r * (1 - q)) / (q + r * (1 - q))
    return down[:, None] * colour * received / np.pi
