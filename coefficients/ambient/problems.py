"""The exported ambient functions as quantities without forms, as samplers are."""

import functools

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from coefficients.ambient import tables
from coefficients.ambient.radiance import LARGEST_DENSITY, ambient_function
from integrals.reference import Axis, Estimate, Reference, leg
from integrals.sampling import Sampling
from programs.functions import group_inputs
from quantities.calling_convention import CallingConvention
from quantities.problem import ExactCode, Problem
from shading import AMBIENT_MODELS, direction, fiber_direction, harmonics
from shading.fuzz.cone_lights import LEAST_ALPHA
from shading.harmonics import LOBE, UNIFORM

# The models of `AMBIENT_MODELS` that are exported, from cheap to precise
EXPORTED = ("talk", "cheap", "recommended", "best")
# Below this v·n, rounding of the vectors moves cosines by a large part of themselves.
_LARGEST_ANGLE = float(np.arccos(0.02))
AXES = (
    Axis("alpha", LEAST_ALPHA, 1.0, "α", meaning="roughness"),
    Axis("density", 0.0, LARGEST_DENSITY, "d", meaning="density"),
    Axis("theta_f", 0.0, np.pi / 2, "θf", "rad", "polar angle of the fibre"),
    Axis("theta_v", 0.0, _LARGEST_ANGLE, "θv", "rad", "polar angle of the view"),
    Axis("phi", -np.pi, np.pi, "φ", "rad", "azimuth of the view", period=2 * np.pi),
    Axis("turn", -np.pi, np.pi, "ψ", "rad", "turn of the surface in the world", period=2 * np.pi),
    Axis("height", -1.0, 1.0, "z", meaning="height of the light"),
    Axis("azimuth", -np.pi, np.pi, "ω", "rad", "azimuth of the light", period=2 * np.pi),
)
# The relative error of these formulas in float64: some roundings
_ROUNDING = 1e-12
_FIBER_ALBEDO, _BASE_ALBEDO = (0.9, 0.5, 0.25), (0.3, 0.6, 0.8)


def _arguments(point: Array) -> Array:
    """Return the 44 numbers that the function takes, at a point (axes,).

    The surface is turned about the diagonal of the world. Red light is a broad lobe about a
    direction s, blue light one about −s, and green light is half of each and half uniform.
    """
    alpha, density, theta_f, theta_v, phi, turn, height, azimuth = point
    local = jnp.stack([jnp.array([0.0, 0.0, 1.0]), direction(theta_v, phi)])
    vectors = jnp.concatenate([local, fiber_direction(theta_f)[None]]) @ _turned(turn).T
    sine = jnp.sqrt(1 - height * height)
    axis = jnp.stack([sine * jnp.cos(azimuth), sine * jnp.sin(azimuth), height])
    red, blue = LOBE * harmonics(axis), LOBE * harmonics(-axis)
    green = (red + blue) / 2 + 0.5 * UNIFORM
    light = jnp.stack([red, green, blue], axis=1)
    colours = jnp.array([*_FIBER_ALBEDO, *_BASE_ALBEDO])
    return jnp.concatenate([vectors.ravel(), jnp.stack([alpha, density]), light.ravel(), colours])


def _turned(angle: Array) -> Array:
    """Return the rotation (3, 3) about the diagonal (1, 1, 1)."""
    diagonal = jnp.ones((3, 3)) / 3
    cross = jnp.array([[0.0, -1.0, 1.0], [1.0, 0.0, -1.0], [-1.0, 1.0, 0.0]]) / np.sqrt(3)
    return diagonal + jnp.cos(angle) * (jnp.eye(3) - diagonal) + jnp.sin(angle) * cross


_argument_rows = jax.jit(jax.vmap(_arguments))


def _problem(name: str) -> Problem:
    model = AMBIENT_MODELS[name]
    made = ambient_function(name)

    @leg(*AXES)
    def closed_form(*point):
        values = made.call(*group_inputs(made, list(_arguments(jnp.stack(point)))))
        return Estimate(jnp.stack(values), jnp.asarray(_ROUNDING))

    reference = Reference(
        name,
        "L",
        f"radiance of fuzz in ambient light by the {name} model ({model.meaning})",
        "",
        AXES,
        Sampling(10, 10, 10),
        closed_form=closed_form,
    )
    exact = ExactCode(
        f"model {name} of docs/ambient-light.md, with tables {tables.G}, {tables.Q} and {tables.R}",
        AXES,
        lambda _: (made,),
        lambda points: (np.asarray(_argument_rows(jnp.asarray(points))),),
        _REMARK,
        "that of the model is in docs/ambient-light.md; as code of this model, "
        "none but the rounding of float64",
    )
    return Problem(reference, (), CallingConvention(name, "", ()), exact_code=exact)


_REMARK = (
    "normalWS, viewWS and fiberWS are unit vectors in the frame of the light, such as world space: "
    "the normal, the direction to the eye, and that of the fibre (its sign does not matter). "
    "light has the nine coefficients of the radiance in real orthonormal spherical harmonics, in "
    "the order L00, L1-1, L10, L11, L2-2, L2-1, L20, L21, L22: those of Ramamoorthi and Hanrahan, "
    "whose functions are 0.282095; 0.488603 (y, z, x); 1.092548 (xy, yz); 0.315392 (3zz - 1); "
    "1.092548 xz; 0.546274 (xx - yy). They are not convolved with a cosine. "
    "The sum of layer and base is the radiance to the eye. Cosines, alpha and density are clamped, "
    "and neither part is negative"
)


@functools.lru_cache(maxsize=1)
def ambient_problems() -> dict[str, Problem]:
    """Return the exported models by name."""
    return {name: _problem(name) for name in EXPORTED}
