"""Radiance of the fuzz layer and of its base in ambient light of nine harmonics, as code.

Each function takes the vectors of the surface in world space, the light as nine colours, and the
material. It returns the radiance of the layer and that of the base below it.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jax.ad_checkpoint import checkpoint_name

from coefficients.ambient import tables
from programs.cost import count_operations
from programs.functions import Function, Parameter, Record, function
from programs.tracing.tracer import trace
from quantities.calling_convention import clamped
from shading import (
    AMBIENT_MODELS,
    LayerLight,
    LayerView,
    ambient_attenuation,
    light_weights,
)
from shading.fuzz.cone_lights import LEAST_ALPHA, LEAST_COSINE
from shading.harmonics import FIRST, FLAT, SECOND, ZONAL

# The largest density of the tables of G and Q
LARGEST_DENSITY = 0.5
_UNIT, _SIGNED = (0.0, 1.0), (-1.0, 1.0)
# The square of the length of the shortest vector that is scaled to one: a number of half precision
_LEAST_SQUARE = 2.0**-14
# Code takes light of any radiance. This range is that of its verification.
_LIGHT = (-64.0, 64.0)
# "normal" and N are reserved in OSL; WS stands for world space.
_SURFACE = (
    Parameter("normalWS", _SIGNED, size=3, shape="vector"),
    Parameter("viewWS", _SIGNED, size=3, shape="vector"),
    Parameter("fiberWS", _SIGNED, size=3, shape="vector"),
)
_MATERIAL = (Parameter("alpha", (LEAST_ALPHA, 1.0)), Parameter("density", (0.0, LARGEST_DENSITY)))
_COLOURS = (
    Parameter("light", _LIGHT, size=27, shape="vectors"),
    Parameter("fiberAlbedo", _UNIT, size=3, shape="vector"),
    Parameter("baseAlbedo", _UNIT, size=3, shape="vector"),
)
_RECORD = Record("FuzzAmbientLight", vectors=("layer", "base"))

Components = Sequence[Array]


class _Surface:
    """Vectors, cosines and material of a point, as values that the code gives names.

    Tables, and the models that read the density, clamp their arguments. The other models do not.
    With `normalised`, vectors of any length become unit vectors. Models with the lit cone need
    this: cosines that belong to no unit vectors may give light a mean direction of any length.
    """

    def __init__(self, vectors: Sequence[Components], alpha, density, normalised: bool):
        scaled = map(_unit, vectors) if normalised else vectors
        self.normal, self.view, self.fiber = map(jnp.stack, scaled)
        self.cos_v = _named("normalDotView", _dot(self.normal, self.view))
        self.cos_vt = _named("viewDotFiber", _dot(self.view, self.fiber))
        self.cos_nt = _named("normalDotFiber", _dot(self.normal, self.fiber))
        self.alpha, self.density = alpha, density

    def moments(self, name: str) -> LayerLight:
        """Return the light of the layer by a model; it reads only what it needs."""
        model = AMBIENT_MODELS[name]
        scattering = tables.scattering(self.cos_v, self.density)
        cosines = self.cos_v, self.cos_vt, self.cos_nt
        if "scattered" not in model.arguments:
            thickness = clamped(self.density, 0.0, LARGEST_DENSITY)
            # These models have a P_s of their own, and do not read this one.
            return model(LayerView(*cosines, self.alpha, thickness, scattering, 0.5))
        limits = ((LEAST_COSINE, 1.0), (-1.0, 1.0), (-1.0, 1.0), (LEAST_ALPHA, 1.0))
        inside = [clamped(x, *ends) for x, ends in zip((*cosines, self.alpha), limits, strict=True)]
        scattered = clamped(tables.scattered(*inside), 0.0, 1.0)
        return model(LayerView(*inside, self.density, scattering, scattered))

    def weights(self, name: str) -> Array:
        """Return the weights (9,) of the harmonics in the radiance of the layer."""
        return light_weights(self.moments(name), self.normal, self.view, self.fiber)

    def received(self) -> list[Array]:
        """Return the weights (9,) of the harmonics in the irradiance over π."""
        x, y, z = self.normal
        flat, first, second, zonal = _RECEIVED
        order1 = [first * y, first * z, first * x]
        order2 = [second * x * y, second * y * z, zonal * (3 * z * z - 1), second * x * z]
        return [jnp.asarray(flat), *order1, *order2, second / 2 * (x * x - y * y)]

    def attenuation(self, albedo: Components) -> list[Array]:
        """Return the attenuation of the base for each colour of the fibres' albedo."""
        q = tables.average_penetration(self.density)
        r = tables.average_scattered(self.alpha, self.cos_nt)
        cos_v = clamped(self.cos_v, LEAST_COSINE, 1.0)
        thickness = clamped(self.density, 0.0, LARGEST_DENSITY)
        return [ambient_attenuation(cos_v, thickness, each, q, r) for each in albedo]


# The factors of the bands of a cosine lobe, π, 2π/3 and π/4, over π, times those of the harmonics
_RECEIVED = (FLAT, 2 / 3 * FIRST, 1 / 4 * SECOND, 1 / 4 * ZONAL)


def _surface(name: str, normal, view, fiber, alpha, density) -> _Surface:
    lit_cone = "density" in AMBIENT_MODELS[name].arguments
    return _Surface((normal, view, fiber), alpha, density, normalised=lit_cone)


def _unit(vector: Components) -> list[Array]:
    inverse = jax.lax.rsqrt(jnp.maximum(_dot(vector, vector), _LEAST_SQUARE))
    return [each * inverse for each in vector]


def ambient_function(name: str) -> Function:
    """Return the function of a model of `shading.AMBIENT_MODELS`, with six results.

    They are the radiance of the layer and that of the base. Raises ValueError for another name.
    """
    if name not in AMBIENT_MODELS:
        raise ValueError(f"no model is called {name!r}: allowed are {', '.join(AMBIENT_MODELS)}")

    def radiances(normal, view, fiber, alpha, density, light, fiber_albedo, base_albedo):
        surface = _surface(name, normal, view, fiber, alpha, density)
        weights = _all_named("weight", surface.weights(name))
        received = _all_named("cosine", surface.received())
        layer = [
            albedo * jnp.maximum(_dot(weights, light[k::3]), 0.0)
            for k, albedo in enumerate(fiber_albedo)
        ]
        base = [
            albedo * down * jnp.maximum(_dot(received, light[k::3]), 0.0)
            for k, (albedo, down) in enumerate(
                zip(base_albedo, surface.attenuation(fiber_albedo), strict=True)
            )
        ]
        return (*layer, *base)

    word = "".join(part.capitalize() for part in name.split("-"))
    summary = "Radiance of the layer of fibres and of the diffuse base below it towards the view."
    parameters = (*_SURFACE, *_MATERIAL, *_COLOURS)
    called = f"FuzzAmbient{word}"
    return function(called, parameters, radiances, summary, 6, "seen", _RECORD)


# What the cost of a function consists of, in the order of `part_costs`
PARTS = ("moments", "weights", "light", "base")


def part_costs(name: str) -> dict[str, int]:
    """Return the operations of each part of a model's function, by the names of `PARTS`.

    "moments" is the model with P_s and G, cosines and clamps. "weights" makes nine weights of the
    moments, "light" multiplies them by nine colours and the albedo, and "base" is the rest. What
    parts share is counted in the first.
    """

    def moments(normal, view, fiber, alpha, density):
        found = _surface(name, normal, view, fiber, alpha, density).moments(name)
        return tuple(each for each in found if not isinstance(each, float))

    def weights(*given):
        return tuple(_surface(name, *given).weights(name))

    def layer(*given):
        return whole.call(*given)[:3]

    whole = ambient_function(name)
    zero = jnp.zeros(())
    count = len(moments([zero] * 3, [zero] * 3, [zero] * 3, zero, zero))
    surface = (*_SURFACE, *_MATERIAL)
    steps = [
        function("Moments", surface, moments, result=count),
        function("Weights", surface, weights, result=9),
        replace(whole, call=layer, result=3, record=None),
        whole,
    ]
    totals = [count_operations(trace(each)).operations for each in steps]
    return dict(zip(PARTS, np.diff(totals, prepend=0).tolist(), strict=True))


def _dot(one: Any, other: Any) -> Any:
    first, *rest = [x * y for x, y in zip(one, other, strict=True)]
    return sum(rest, first)


def _named(name: str, value: Array) -> Array:
    return checkpoint_name(value, name)


def _all_named(name: str, values: Sequence[Array] | Array) -> list[Array]:
    return [_named(f"{name}{k}", each) for k, each in enumerate(values)]
