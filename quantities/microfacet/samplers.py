"""Samplers of visible GGX normals, and their densities, as functions to export.

A sampler is declared as a quantity whose closed form has four results: the light, and the weight of
its radiance. It has no forms, and no command but those for code knows it. Its code is verified at
points of the view, the roughnesses and the random numbers.
"""

import functools
from collections.abc import Callable
from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jax.ad_checkpoint import checkpoint_name

from integrals.reference import Axis, Estimate, Reference, leg
from integrals.sampling import Sampling
from programs.functions import Function, Parameter, Record, function
from quantities.calling_convention import CallingConvention, clamped
from quantities.problem import ExactCode, Problem
from shading.microfacet.reflection_cone import (
    FLOAT32_STEPS,
    FLOAT64_STEPS,
    cone_of,
    upper_area,
)
from shading.microfacet.sampling import (
    cap_bound,
    cap_light,
    disk_light,
    point_across,
    stretched_length,
    upper_light,
)

LEAST_ALPHA = 0.01
AXES = (
    Axis("theta_o", 0.0, np.pi / 2, "θo", "rad", "polar angle of the view"),
    Axis("phi_o", -np.pi, np.pi, "φo", "rad", "azimuth of the view", period=2 * np.pi),
    Axis("alpha_x", LEAST_ALPHA, 1.0, "αx", meaning="roughness along x", scale="logarithmic"),
    Axis("alpha_y", LEAST_ALPHA, 1.0, "αy", meaning="roughness along y", scale="logarithmic"),
    Axis("u1", 0.0, 1.0, "u₁", meaning="first random number"),
    Axis("u2", 0.0, 1.0, "u₂", meaning="second random number"),
    Axis("side", 0.0, 1.0, "s", meaning="below ½ for the point itself, else its mirror image"),
)
# The third random number is put at least so far from where it makes another choice. Nearer to there
# rounding decides, and exported code may rightly differ from its float64 form.
_MARGIN = 0.02
# The largest number below one in each precision
_LARGEST = {"half": 1 - 2.0**-11, "float": 1 - 2.0**-24, "double": 1 - 2.0**-53}
# The relative error of the closed forms in float64: some roundings
_ROUNDING = 1e-14
_STEPS = {"half": FLOAT32_STEPS, "float": FLOAT32_STEPS, "double": FLOAT64_STEPS}
_VIEW = (("Vx", (-1.0, 1.0)), ("Vy", (-1.0, 1.0)), ("Vz", (0.0, 1.0)))
_ALPHAS = (("alphaX", (LEAST_ALPHA, 1.0)), ("alphaY", (LEAST_ALPHA, 1.0)))
_RECORD = Record("GgxSample", "array", "w")

Components = tuple[Array, ...]


@dataclass(frozen=True)
class _Sampler:
    """A sampler: `light` maps (view, αx, αy, numbers, steps) to three components.

    `area` maps (view, αx, αy, steps) to N. `numbers` is how many random numbers it takes.
    """

    key: str
    function: str
    meaning: str
    numbers: int
    light: Callable[..., Components]
    area: Callable[..., Array]


def _visible_area(x, y, z, alpha_x, alpha_y, _):
    return (stretched_length(x, y, z, alpha_x, alpha_y) + z) / 2


def _bounded_area(x, y, z, alpha_x, alpha_y, _):
    bound = cap_bound(x, y, z, alpha_x, alpha_y)
    return (stretched_length(x, y, z, alpha_x, alpha_y) + bound * z) / 2


def _upper_area(*given):
    return upper_area(cone_of(*given))


def _disk_light(*given):
    return disk_light(*given[:-1])


def _cap_light(*given):
    return cap_light(*given[:-1], 1.0)


def _bounded_light(*given):
    return cap_light(*given[:-1], cap_bound(*given[:5]))


def _upper_light(*given):
    return upper_light(*given[:-1], cone_of(*given[:5], given[-1]))


_SAMPLERS = (
    _Sampler(
        "ggx-upper",
        "GgxUpper",
        "visible normals whose reflections are above the horizon",
        3,
        _upper_light,
        _upper_area,
    ),
    _Sampler(
        "ggx-bounded-cap",
        "GgxBoundedCap",
        "visible normals by a bounded spherical cap",
        2,
        _bounded_light,
        _bounded_area,
    ),
    _Sampler(
        "ggx-cap", "GgxCap", "visible normals by a spherical cap", 2, _cap_light, _visible_area
    ),
    _Sampler("ggx-disk", "GgxDisk", "visible normals by a disk", 2, _disk_light, _visible_area),
)


def _weighted(sampler: _Sampler, steps: int, view: Components, alphas: Components, numbers):
    """Return the light, and its weight 2Nν/(μσ(i) + νσ(o)), which is zero below the horizon."""
    light_x, light_y, light_z = sampler.light(*view, *alphas, *numbers, steps)
    area = sampler.area(*view, *alphas, steps)
    sigma_o = stretched_length(*view, *alphas)
    height = jnp.maximum(light_z, 0.0)
    sigma_i = stretched_length(light_x, light_y, height, *alphas)
    weight = 2 * area * height / (view[2] * sigma_i + height * sigma_o)
    # Above a grazing view, a height of zero would be divided by zero.
    return light_x, light_y, light_z, jnp.where(height > 0, weight, 0.0)


def _density(sampler: _Sampler, steps: int, view: Components, alphas: Components, light):
    """Return D(h)/(4N) for a light above the horizon, else zero."""
    alpha_x, alpha_y = alphas
    half_x, half_y, half_z = (a + b for a, b in zip(view, light, strict=True))
    length2 = half_x * half_x + half_y * half_y + half_z * half_z
    ratio = alpha_y / alpha_x
    product = alpha_x * alpha_y
    stretched2 = half_x * half_x * ratio + half_y * half_y / ratio + half_z * half_z * product
    share = length2 / stretched2
    area = sampler.area(*view, *alphas, steps)
    density = product * share * share / (4 * np.pi * area)
    return jnp.where(light[2] > 0, density, 0.0)


def _sampling_function(sampler: _Sampler, precision: str) -> Function:
    numbers = [(f"u{k + 1}", (0.0, 1.0)) for k in range(sampler.numbers)]

    def sample(*given):
        view, alphas = _clamped(given[:5])
        random = [
            checkpoint_name(clamped(each, 0.0, _LARGEST[precision]), f"random{k + 1}")
            for k, each in enumerate(given[5:])
        ]
        return _weighted(sampler, _STEPS[precision], view, alphas, random)

    parameters = [Parameter(*each) for each in (*_VIEW, *_ALPHAS, *numbers)]
    summary = f"A light by {sampler.meaning}: w[0..2], and the weight w[3] of its radiance."
    name = f"{sampler.function}Sample"
    return function(name, parameters, sample, summary, 4, "drawn", _RECORD)


def _density_function(sampler: _Sampler, precision: str) -> Function:
    def density(*given):
        view, alphas = _clamped(given[:5])
        return _density(sampler, _STEPS[precision], view, alphas, given[5:])

    light = [("Lx", (-1.0, 1.0)), ("Ly", (-1.0, 1.0)), ("Lz", (-1.0, 1.0))]
    parameters = [Parameter(*each) for each in (*_VIEW, *_ALPHAS, *light)]
    summary = f"Density of {sampler.function}Sample's lights above the horizon, per steradian."
    return function(f"{sampler.function}Pdf", parameters, density, summary)


def _clamped(given: Components) -> tuple[Components, Components]:
    x, y, z, alpha_x, alpha_y = given
    alpha_x = clamped(alpha_x, LEAST_ALPHA, 1.0)
    alpha_y = clamped(alpha_y, LEAST_ALPHA, 1.0)
    cos_view = jnp.maximum(z, 0.0)
    return (x, y, cos_view), (alpha_x, alpha_y)


def _drawn_from(theta, phi, alpha_x, alpha_y, first, second, side):
    """Return the view, and random numbers of which the third is far from where the choice changes.

    `side` below ½ stands for the point itself, else for its mirror image.
    """
    sin_theta = jnp.sin(theta)
    view = (sin_theta * jnp.cos(phi), sin_theta * jnp.sin(phi), jnp.cos(theta))
    first = jnp.minimum(first, _LARGEST["half"])
    cone = cone_of(*view, alpha_x, alpha_y, FLOAT64_STEPS)
    point = point_across(cone, first, second)
    chance = (1 + point.lean / point.along) / 2
    itself = jnp.where(chance < 2 * _MARGIN, False, (side < 0.5) | (chance > 1 - 2 * _MARGIN))
    within = jnp.where(side < 0.5, 2 * side, 2 * side - 1)
    below, above = within * (chance - _MARGIN), 1 - within * (1 - chance - _MARGIN)
    return view, (first, second, jnp.where(itself, below, above))


@functools.partial(jax.jit, static_argnums=0)
def _arguments(numbers: int, points: Array) -> Array:
    """Return the view, the roughnesses and the random numbers at points (n, axes)."""

    def row(point):
        view, random = _drawn_from(*point)
        return jnp.stack([*view, *point[2:4], *random[:numbers]])

    return jax.vmap(row)(points)


@jax.jit
def _lights(points: Array) -> Array:
    """Return the view, the roughnesses and a light that the upper sampler draws there."""

    def row(point):
        view, random = _drawn_from(*point)
        light = _upper_light(*view, *point[2:4], *random, FLOAT64_STEPS)
        return jnp.stack([*view, *point[2:4], *light])

    return jax.vmap(row)(points)


def _sampler_problem(sampler: _Sampler) -> Problem:
    @leg(*AXES)
    def closed_form(*point):
        view, random = _drawn_from(*point)
        some = random[: sampler.numbers]
        drawn = _weighted(sampler, FLOAT64_STEPS, view, (point[2], point[3]), some)
        return Estimate(jnp.stack(drawn), jnp.asarray(_ROUNDING))

    return _problem(
        sampler.key,
        "(i, w)",
        f"a light i drawn by {sampler.meaning}, and the weight w of its radiance",
        "i is distributed like D(h)/(4N), w = f (i·n)/density without the Fresnel term",
        closed_form,
        sampler,
        _sampling_function,
        functools.partial(_arguments, sampler.numbers),
        "V is the view and w[0..2] the light, unit vectors in the frame of the surface, Vz >= 0. "
        f"u1 to u{sampler.numbers} are uniform in [0, 1). The mean of w[3] times the radiance from "
        "the light times Fresnel's factor is the reflected radiance",
    )


def _density_problem(sampler: _Sampler) -> Problem:
    @leg(*AXES)
    def closed_form(*point):
        view, random = _drawn_from(*point)
        alphas = (point[2], point[3])
        light = _upper_light(*view, *alphas, *random, FLOAT64_STEPS)
        density = _density(sampler, FLOAT64_STEPS, view, alphas, light)
        return Estimate(density, _ROUNDING * density)

    return _problem(
        f"{sampler.key}-pdf",
        "p(i)",
        f"density of lights drawn by {sampler.meaning}",
        "D(h)/(4N) per steradian above the horizon",
        closed_form,
        sampler,
        _density_function,
        _lights,
        "V is the view and L the light, unit vectors in the frame of the surface with Vz >= 0",
    )


def _problem(key, symbol, meaning, definition, closed_form, sampler, make, arguments, remark):
    reference = Reference(
        key, symbol, meaning, definition, AXES, Sampling(10, 10, 10), closed_form=closed_form
    )
    stepped = sampler.area is _upper_area
    left = "what the step of the eigenvalue leaves" if stepped else "the rounding of float64"
    exact = ExactCode(
        "closed form",
        AXES,
        lambda precision: (make(sampler, precision),),
        lambda points: (np.asarray(arguments(points)),),
        remark,
        f"none but {left}",
    )
    return Problem(reference, (), CallingConvention(key, "", ()), exact_code=exact)


# By name; a sampler and its density follow each other.
SAMPLERS: dict[str, Problem] = {
    each.name: each
    for sampler in _SAMPLERS
    for each in (_sampler_problem(sampler), _density_problem(sampler))
}
