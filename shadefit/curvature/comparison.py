"""Which curvature a skin fit should be given: each against diffusion over whole surfaces.

A skin fit has the light on a cylinder that is lit across its axis. Here it is replaced by the exact
integral, so that all of the error comes from the choice of the curvature.
"""

from collections.abc import Callable
from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np

from integrals.skin import cylinder_scattering, sphere_scattering
from shadefit.curvature.blocks import over_rows
from shadefit.curvature.diffusion import NODES, diffused, patch
from shadefit.curvature.surfaces import Ellipsoid, Torus, normals_and_tensors, random_points
from shadefit.curvature.tensors import frame_tensors, frames_of
from shading.curvature import (
    along_light,
    bending_along_light,
    effective,
    mean,
    projected_light,
    published,
)
from shading.skin.profiles import SKIN

SURFACES: dict[str, Ellipsoid | Torus] = {
    "sphere 10": Ellipsoid((10.0, 10.0, 10.0)),
    "ellipsoid 60, 7, 7": Ellipsoid((60.0, 7.0, 7.0)),
    "ellipsoid 20, 10, 7": Ellipsoid((20.0, 10.0, 7.0)),
    "ellipsoid 12, 8, 5": Ellipsoid((12.0, 8.0, 5.0)),
    "torus 15, 6": Torus(15.0, 6.0),
}


def _none(tensor: jax.Array, light: jax.Array) -> jax.Array:
    return 0.0 * (jnp.sum(tensor) + jnp.sum(light))


def _mean(tensor: jax.Array, light: jax.Array) -> jax.Array:
    return mean(tensor) + 0.0 * jnp.sum(light)


# A method maps a tensor and a projected light to a curvature, of which the absolute value counts.
METHODS: dict[str, Callable[[jax.Array, jax.Array], jax.Array]] = {
    "no curvature": _none,
    "mean": _mean,
    "along the light": along_light,
    "published shader": published,
    "bending along the light": bending_along_light,
    "effective": effective,
}


@dataclass(frozen=True)
class Lit:
    """Points of a surface, each with a light and its diffused light `values` (n, channels)."""

    points: np.ndarray
    normals: np.ndarray
    tensors: np.ndarray
    frames: np.ndarray
    lights: np.ndarray
    values: np.ndarray


def lit(surface: Ellipsoid | Torus, count: int, seed: int, nodes: int = NODES) -> Lit:
    """Return random points with random lights, both uniform, and the light diffused there."""
    points = random_points(surface, count, seed)
    lights = np.random.default_rng(seed + 1).normal(size=(count, 3))
    lights /= np.linalg.norm(lights, axis=1)[:, None]
    normals, matrices = normals_and_tensors(surface, points)
    frames = frames_of(normals)
    values = [
        diffused(patch(surface, point, nodes), point, light, SKIN)
        for point, light in zip(points, lights, strict=True)
    ]
    tensors = frame_tensors(matrices, frames)
    return Lit(points, normals, tensors, frames, lights, np.array(values))


def errors(seen: Lit) -> dict[str, np.ndarray]:
    """Return the errors (n, channels) of each method: its cylinder's light minus the exact."""
    return {name: shaded(name, seen) - seen.values for name in METHODS}


def shaded(name: str, seen: Lit) -> np.ndarray:
    """Return the light (n, channels) of a cylinder with the curvature of a method."""
    return over_rows(_SHADERS[name], seen.tensors, seen.frames, seen.normals, seen.lights)[0]


def on_sphere(radius: float, seen: Lit) -> np.ndarray:
    """Return the exact light (n, channels) at the points of a sphere, by another method."""
    cosines = np.sum(seen.normals * seen.lights, axis=1)
    return over_rows(_on_sphere, cosines, np.full(len(cosines), 1 / radius))[0]


def _on_sphere(cosine: jax.Array, kappa: jax.Array) -> tuple[jax.Array]:
    return (sphere_scattering(SKIN, jnp.arccos(jnp.clip(cosine, -1, 1)), kappa),)


def _shader(method: Callable) -> Callable:
    def row(tensor, frame, normal, light):
        kappa = jnp.abs(method(tensor, projected_light(frame, light)))
        theta = jnp.arccos(jnp.clip(normal @ light, -1, 1))
        return (cylinder_scattering(SKIN, theta, kappa),)

    return row


_SHADERS = {name: _shader(method) for name, method in METHODS.items()}
