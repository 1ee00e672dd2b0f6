"""Which curvature a skin fit should be given: each against diffusion over whole surfaces.

A skin fit has the light on a cylinder that is lit across its axis. Here it is replaced by the exact
integral, so that all of the error comes from the choice of the curvature. Methods with "blurred"
take the tensor and the drift that are smoothed by a Gaussian of `BLUR`, those with "talk" the
tensor that is made convex and smoothed by the two widths of the talk, and the others the tensor of
the point.
"""

import functools
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import jax
import jax.numpy as jnp
import numpy as np

from integrals.skin import cylinder_scattering, sphere_scattering
from shadefit.curvature.blocks import over_rows
from shadefit.curvature.diffusion import NODES, blurred, diffused, patch
from shadefit.curvature.smoothing import WIDTHS
from shadefit.curvature.surfaces import (
    Ellipsoid,
    Finger,
    RoundedFinger,
    Surface,
    Torus,
    normals_and_tensors,
    random_points,
)
from shadefit.curvature.tensors import frame_tensors, frames_of
from shading.curvature import (
    along_light,
    bending_along_light,
    drifted,
    effective,
    equivalent_cylinder,
    mean,
    projected_light,
    published,
)
from shading.skin.profiles import SKIN

SURFACES: dict[str, Surface] = {
    "sphere 10": Ellipsoid((10.0, 10.0, 10.0)),
    "ellipsoid 60, 7, 7": Ellipsoid((60.0, 7.0, 7.0)),
    "ellipsoid 20, 10, 7": Ellipsoid((20.0, 10.0, 7.0)),
    "ellipsoid 12, 8, 5": Ellipsoid((12.0, 8.0, 5.0)),
    "torus 15, 6": Torus(15.0, 6.0),
    "capsule 7, 25": Finger(7.0, 25.0),
    "rounded finger 7, 32": RoundedFinger(7.0, 32.0),
}


# The width σ in mm of the blur of tensors and normals, near that of red light, √1.38 mm.
BLUR = 1.4


def _none(tensor: jax.Array, light: jax.Array) -> jax.Array:
    return 0.0 * (jnp.sum(tensor) + jnp.sum(light))


def _mean(tensor: jax.Array, light: jax.Array) -> jax.Array:
    return mean(tensor) + 0.0 * jnp.sum(light)


def _of_curvature(method: Callable[[jax.Array, jax.Array], jax.Array]) -> Callable:
    """Return a shader of the absolute value of the curvature of a tensor and a projected light."""

    def shade(tensor, drift, light, cosine):
        # The drift does not count, but all shaders have the same arguments.
        return _cylinder(cosine + 0.0 * jnp.sum(drift), jnp.abs(method(tensor, light)))

    return shade


def _equivalent(tensor, drift, light, cosine):
    """Return the light of the equivalent cylinder; a drift of zero has no effect."""

    def channel(variance, index):
        cylinder = equivalent_cylinder(tensor, light, drifted(cosine, drift, light, variance))
        return cylinder.scale * _cylinder(cylinder.cosine, cylinder.curvature)[index]

    return jax.vmap(channel)(jnp.asarray(SKIN.mean_variances), jnp.arange(SKIN.channels))


def _cylinder(cosine: jax.Array, kappa: jax.Array) -> jax.Array:
    return cylinder_scattering(SKIN, jnp.arccos(jnp.clip(cosine, -1, 1)), kappa)


# A method has a shader, which returns channels of a tensor, a drift, a projected light and n·l, and
# says which tensor it takes.
Source = Literal["point", "blurred", "talk"]
METHODS: dict[str, tuple[Callable, Source]] = {
    "no curvature": (_of_curvature(_none), "point"),
    "mean": (_of_curvature(_mean), "point"),
    "along the light": (_of_curvature(along_light), "point"),
    "along the light, talk's blur": (_of_curvature(along_light), "talk"),
    "along the light, blurred": (_of_curvature(along_light), "blurred"),
    "published shader": (_of_curvature(published), "point"),
    "bending along the light": (_of_curvature(bending_along_light), "point"),
    "effective": (_of_curvature(effective), "point"),
    "effective, blurred": (_of_curvature(effective), "blurred"),
    "equivalent cylinder": (_equivalent, "point"),
    "equivalent cylinder, blurred, with drift": (_equivalent, "blurred"),
}


@dataclass(frozen=True)
class Lit:
    """Points of a surface, each with a light and its diffused light `values` (n, channels)."""

    points: np.ndarray
    normals: np.ndarray
    tensors: np.ndarray
    blurred_tensors: np.ndarray
    talk_tensors: np.ndarray
    drifts: np.ndarray
    frames: np.ndarray
    lights: np.ndarray
    values: np.ndarray


def lit(surface: Surface, count: int, seed: int, nodes: int = NODES) -> Lit:
    """Return random points with random lights, both uniform, and the light diffused there."""
    points = random_points(surface, count, seed)
    lights = np.random.default_rng(seed + 1).normal(size=(count, 3))
    lights /= np.linalg.norm(lights, axis=1)[:, None]
    return lit_at(surface, points, lights, nodes)


def lit_at(surface: Surface, points: np.ndarray, lights: np.ndarray, nodes: int = NODES) -> Lit:
    """Return points (n, 3) of a surface with lights (n, 3), and the light diffused there."""
    normals, matrices = normals_and_tensors(surface, points)
    frames = frames_of(normals)
    values, tensors, talk, drifts = [], [], [], []
    for point, light, frame in zip(points, lights, frames, strict=True):
        whole = patch(surface, point, nodes)
        values.append(diffused(whole, point, light, SKIN))
        tensor, drift = blurred(surface, whole, point, frame, BLUR)
        tensors.append(tensor)
        drifts.append(drift)
        wide = [blurred(surface, whole, point, frame, width, convex=True)[0] for width in WIDTHS]
        talk.append(np.mean(wide, axis=0))
    return Lit(
        points,
        normals,
        frame_tensors(matrices, frames),
        np.array(tensors),
        np.array(talk),
        np.array(drifts),
        frames,
        lights,
        np.array(values),
    )


def errors(seen: Lit) -> dict[str, np.ndarray]:
    """Return the errors (n, channels) of each method: its cylinder's light minus the exact."""
    return {name: shaded(name, seen) - seen.values for name in METHODS}


def shaded(name: str, seen: Lit) -> np.ndarray:
    """Return the light (n, channels) of a cylinder by a method."""
    shader, source = METHODS[name]
    tensors = {
        "point": seen.tensors,
        "blurred": seen.blurred_tensors,
        "talk": seen.talk_tensors,
    }
    drifts = seen.drifts if source == "blurred" else np.zeros_like(seen.drifts)
    given = tensors[source], drifts, seen.frames, seen.normals, seen.lights
    return over_rows(_row(shader), *given)[0]


def on_sphere(radius: float, cosines: np.ndarray) -> np.ndarray:
    """Return the exact light (n, channels) at points of a sphere, from n·l (n,)."""
    return over_rows(_on_sphere, cosines, np.full(len(cosines), 1 / radius))[0]


def _on_sphere(cosine: jax.Array, kappa: jax.Array) -> tuple[jax.Array]:
    return (sphere_scattering(SKIN, jnp.arccos(jnp.clip(cosine, -1, 1)), kappa),)


@functools.cache
def _row(shader: Callable) -> Callable:
    def row(tensor, drift, frame, normal, light):
        return (shader(tensor, drift, projected_light(frame, light), normal @ light),)

    return row
