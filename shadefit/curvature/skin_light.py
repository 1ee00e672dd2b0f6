"""The light on skin as renderers shade it: N·L, a lookup table, and fits, by several curvatures.

`SHADERS` has a function for each, which takes the points of a surface and the direction to a light.
"""

import functools
from collections.abc import Callable
from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float, Int

from coefficients.catalogue import resolve
from coefficients.exported_code import exported_values
from coefficients.lut import bake
from coefficients.lut.texture import Lut
from integrals.reference import restricted
from integrals.skin.references import CHANNELS
from quantities import problem
from shadefit.curvature.blocks import over_rows
from shadefit.curvature.meshes import Mesh
from shadefit.curvature.smoothing import smoothed_with_drift
from shadefit.curvature.tensors import Curvature, frame_tensors, frames_of, space_tensors
from shading.curvature import along_light, drifted, effective, equivalent_cylinder, projected_light
from shading.skin.profiles import SKIN

# The part of the light that skin returns, linear red, green and blue
ALBEDO = np.array([0.80, 0.45, 0.32])
# Fits of 20 coefficients a channel, for curvature up to 0.5/mm
FITS = tuple(f"best/skin-cylinder-{channel}-63" for channel in CHANNELS)
# The size of the lookup table, and its largest curvature in 1/mm
LUT_SIZE, LUT_CURVATURE = 128, 0.5


@dataclass(frozen=True)
class Skin:
    """Points of a surface, or vertices of a mesh, with all that shading takes, in space.

    * `normals` (n, 3): unit vectors.
    * `tensors` (n, 3, 3): curvature as the user smooths it, in 1/mm.
    * `blurred` (n, 3, 3) and `drifts` (n, 3): curvature and drift blurred by `DRIFT_WIDTH`, in 1/mm
      and 1/mm², for the equivalent cylinder.
    """

    normals: Float[np.ndarray, "n 3"]
    tensors: Float[np.ndarray, "n 3 3"]
    blurred: Float[np.ndarray, "n 3 3"]
    drifts: Float[np.ndarray, "n 3"]

    def at(self, corners: Int[np.ndarray, "p 3"], weights: Float[np.ndarray, "p 3"]) -> "Skin":
        """Return the points that are weighted means of three others each."""

        def mean(values: np.ndarray) -> np.ndarray:
            return np.einsum("pk,pk...->p...", weights, values[corners])

        normals = mean(self.normals)
        lengths = np.linalg.norm(normals, axis=1)[:, None]
        normals = np.where(lengths > 0, normals / np.where(lengths > 0, lengths, 1.0), [0.0, 0, 1])
        return Skin(normals, mean(self.tensors), mean(self.blurred), mean(self.drifts))


def skin_of(mesh: Mesh, raw: Curvature, chosen: Curvature, width: float) -> Skin:
    """Return the vertices of a mesh as skin, with curvature that is raw and as the user chose it.

    `width` is the σ in mm by which the raw curvature and the normals are blurred for the equivalent
    cylinder.
    """
    soft, drift = smoothed_with_drift(mesh, raw, width)
    return Skin(
        mesh.normals,
        space_tensors(chosen.tensors, chosen.frames),
        space_tensors(soft.tensors, soft.frames),
        np.einsum("na,nai->ni", drift, raw.frames),
    )


def _lambert(skin: Skin, light: np.ndarray) -> np.ndarray:
    return np.repeat(np.maximum(skin.normals @ light, 0.0)[:, None], len(CHANNELS), axis=1)


def _from_table(skin: Skin, light: np.ndarray) -> np.ndarray:
    points = np.column_stack([skin.normals @ light, _curvature(skin, light, along_light)])
    return np.column_stack([lut(points) for lut in luts()])


def _from_fit(skin: Skin, light: np.ndarray) -> np.ndarray:
    points = np.column_stack([skin.normals @ light, _curvature(skin, light, effective)])
    return _fitted(*[points] * len(CHANNELS))


def _from_equivalent(skin: Skin, light: np.ndarray) -> np.ndarray:
    frames = frames_of(skin.normals)
    count = len(skin.normals)
    drifts = np.einsum("nai,ni->na", frames, skin.drifts)
    found = [
        over_rows(
            _equivalent,
            frame_tensors(skin.blurred, frames),
            drifts,
            frames,
            skin.normals,
            np.tile(light, (count, 1)),
            np.full(count, variance),
        )
        for variance in SKIN.mean_variances
    ]
    values = _fitted(*(np.column_stack(each[:2]) for each in found))
    return values * np.column_stack([each[2] for each in found])


# By name: a function that returns D (n, 3) of red, green and blue light at points of a surface, for
# a unit vector to a light
SHADERS: dict[str, Callable[[Skin, np.ndarray], np.ndarray]] = {
    "N·L": _lambert,
    "LUT, κ along the light": _from_table,
    "fit, effective κ": _from_fit,
    "fit, equivalent cylinder": _from_equivalent,
}


@functools.cache
def luts() -> tuple[Lut, ...]:
    """Return lookup tables of 8 bits for the channels, evenly in the cosine and in √κ."""
    made = []
    for channel in CHANNELS:
        owner = problem(f"skin-cylinder-{channel}")
        axes = restricted(owner.axes, curvature=(0.0, LUT_CURVATURE))
        made.append(bake(owner.reference.values, axes, (LUT_SIZE, LUT_SIZE), texel="unorm8"))
    return tuple(made)


def _fitted(*points: np.ndarray) -> np.ndarray:
    """Return the fits of the channels at points (n, 2) of each."""
    parts = zip(FITS, points, strict=True)
    return np.column_stack([exported_values(resolve(name), each) for name, each in parts])


def _curvature(skin: Skin, light: np.ndarray, method: Callable) -> np.ndarray:
    frames = frames_of(skin.normals)
    tensors = frame_tensors(skin.tensors, frames)
    lights = np.tile(light, (len(frames), 1))
    return np.abs(over_rows(_row(method), tensors, frames, lights)[0])


@functools.cache
def _row(method: Callable) -> Callable:
    def row(tensor: jax.Array, frame: jax.Array, light: jax.Array) -> tuple[jax.Array]:
        return (jnp.asarray(method(tensor, projected_light(frame, light))),)

    return row


def _equivalent(tensor, drift, frame, normal, light, variance) -> tuple[jax.Array, ...]:
    along = projected_light(frame, light)
    return tuple(
        equivalent_cylinder(tensor, along, drifted(normal @ light, drift, along, variance))
    )
