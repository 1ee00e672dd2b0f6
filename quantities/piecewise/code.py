"""A fitted NDF as functions for shaders: its value, the hidden area H, and samplers of normals.

The functions are straight-line: every knot contributes a term, which is zero where it should not
count. So the code has neither loops, nor searches, nor textures; its knots are constants.
"""

from collections.abc import Callable

import jax.numpy as jnp
import numpy as np
from jax import Array

from programs import Function, Parameter, function
from quantities.piecewise.code_kernels import LEAST, Places, hidden_code, places_of, view_of
from quantities.piecewise.visible_code import (
    areas_below,
    drawn_azimuth,
    drawn_azimuth_of_blend,
    drawn_drop,
    either,
    segment_at,
)
from shading.piecewise.blend import Blend, weights
from shading.piecewise.ndf import Profile

_COSINE, _UNIT, _SIDE = (0.0, 1.0), (0.0, 1.0), (-1.0, 1.0)
_VIEW = (Parameter("Vx", _SIDE), Parameter("Vy", _SIDE), Parameter("Vz", _COSINE))
_RANDOM = (Parameter("u1", _UNIT), Parameter("u2", _UNIT))
# Steps for Kepler's equation. Normals are then within 1e-4 of the library's (tests).
_KEPLER_STEPS = 4


def ndf_functions(ndf: Profile | Blend, name: str = "Ndf") -> tuple[Function, ...]:
    """Return the functions of an NDF that is linear in cos²θ, whose names begin with `name`.

    * `{name}D(NdotH)`: D, per steradian. For a blend, the arguments are Hx, Hy, Hz.
    * `{name}Hidden(NdotV)`: H = Λ·NdotV, of the view, and of the light. For a blend, Vx, Vy, Vz.
    * `{name}Visibility(NdotV, hiddenV, NdotL, hiddenL)`: G2/(4 NdotV NdotL) from both H.
    * `{name}SquaredSine(xi)`: sin²θ of a normal with the density D cos θ, from xi in [0, 1]. A
      blend has `{name}Normal(u1, u2)` instead, the three components of such a normal.
    * `{name}VisibleNormal(Vx, Vy, Vz, u1, u2)`: a normal that is visible from the unit vector V,
      with the density D max(V·m, 0)/(Vz + H).

    Vectors are unit vectors in the frame of the surface, whose z axis is n. Raises ValueError for
    an NDF that is linear in the angle, whose H has no closed form.
    """
    if isinstance(ndf, Blend):
        return _blend_functions(_Mixture(ndf), name)
    places = places_of(ndf)
    return (
        function(
            f"{name}D",
            (Parameter("NdotH", _COSINE),),
            lambda NdotH: _density(places, (1 - NdotH) * (1 + NdotH)),
            "Return D, the density of normals per steradian.",
        ),
        function(
            f"{name}Hidden",
            (Parameter("NdotV", _COSINE),),
            lambda NdotV: hidden_code(places, view_of(NdotV)),
            "Return Lambda * NdotV, the projected area of normals that face away.",
        ),
        _visibility_function(name),
        function(
            f"{name}SquaredSine",
            (Parameter("xi", _UNIT),),
            lambda xi: _squared_sine(places, xi),
            "Return the squared sine of a random normal's angle, from xi in [0, 1].",
        ),
        _visible_function(name, lambda *given: _visible_normal(places, *given)),
    )


class _Mixture:
    """The constants of a blend: those of both profiles, and their weights."""

    def __init__(self, ndf: Blend):
        self.x, self.y = places_of(ndf.x), places_of(ndf.y)
        share, rest = weights(ndf)
        self.share, self.rest = float(share), float(rest)


def _blend_functions(mixture: _Mixture, name: str) -> tuple[Function, ...]:
    half = tuple(Parameter(f"H{each}", _SIDE) for each in "xy")
    return (
        function(
            f"{name}D",
            (*half, Parameter("Hz", _COSINE)),
            lambda Hx, Hy, Hz: _blend_density(mixture, Hx, Hy, Hz),
            "Return D, the density of normals per steradian; H is a unit vector.",
        ),
        function(
            f"{name}Hidden",
            _VIEW,
            lambda Vx, Vy, Vz: _blend_hidden(mixture, Vx, Vy, Vz),
            "Return Lambda * Vz, the projected area of normals that face away from V.",
        ),
        _visibility_function(name),
        function(
            f"{name}Normal",
            _RANDOM,
            lambda u1, u2: _blend_normal(mixture, u1, u2),
            "A random normal with the density D * drawn[2], from u1 and u2 in [0, 1).",
            3,
            "drawn",
        ),
        _visible_function(name, lambda *given: _blend_visible_normal(mixture, *given)),
    )


def _visibility_function(name: str) -> Function:
    pair = [Parameter("NdotV", (1e-3, 1.0)), Parameter("hiddenV", (0.0, 2.0))]
    pair += [Parameter("NdotL", (1e-3, 1.0)), Parameter("hiddenL", (0.0, 2.0))]
    text = "Return the height-correlated G2 / (4 NdotV NdotL)."
    return function(f"{name}Visibility", pair, _visibility, text)


def _visible_function(name: str, call: Callable[..., tuple[Array, ...]]) -> Function:
    text = "A random normal that is visible from the unit vector V, from u1 and u2 in [0, 1)."
    return function(f"{name}VisibleNormal", (*_VIEW, *_RANDOM), call, text, 3, "drawn")


def _density(places: Places, squared) -> Array:
    """Return D where sin²θ is `squared`."""
    x, values = places.squares, places.values
    # From the horizon upwards: the small values of the tail are not lost beside the peak.
    total = jnp.asarray(values[-1]) * jnp.ones_like(squared)
    for k in range(len(x) - 2, -1, -1):
        ramp = (x[k + 1] - squared) * (1 / (x[k + 1] - x[k]))
        if k < len(x) - 2:
            ramp = jnp.maximum(ramp, 0.0)
        if k > 0:
            ramp = jnp.minimum(ramp, 1.0)
        total = total + (values[k] - values[k + 1]) * ramp
    return total


def _blend_density(mixture: _Mixture, x, y, z) -> Array:
    along, across = x * x, y * y
    level = along + across
    part = along / jnp.maximum(level, LEAST)
    # In the pole D does not depend on the azimuth: any part is right.
    first = mixture.share * part * _density(mixture.x, level)
    return 2 * (first + mixture.rest * (1 - part) * _density(mixture.y, level))


def _visibility(NdotV, hiddenV, NdotL, hiddenL) -> Array:
    return 0.25 / (NdotV * NdotL + hiddenV * NdotL + hiddenL * NdotV)


def _azimuth_of(x, y) -> tuple[Array, Array]:
    """Return the cosine and the sine of the azimuth of a direction; 1 and 0 at the normal."""
    level = x * x + y * y
    scale = jnp.where(level > 0, 1 / jnp.sqrt(jnp.where(level > 0, level, 1.0)), 0.0)
    return jnp.where(level > 0, x * scale, 1.0), y * scale


def _doubled(cosine, sine) -> tuple[Array, Array]:
    return (cosine - sine) * (cosine + sine), 2 * sine * cosine


def _blend_hidden(mixture: _Mixture, x, y, z) -> Array:
    turn, _ = _doubled(*_azimuth_of(x, y))
    first = hidden_code(mixture.x, view_of(z, turn))
    return mixture.share * first + mixture.rest * hidden_code(mixture.y, view_of(z, -turn))


def _squared_sine(places: Places, xi) -> Array:
    x, values = places.squares, places.values
    widths = np.diff(x)
    # In units of π, in which D (sin²θ) has the mass of a trapezoid.
    parts = widths * (values[1:] + values[:-1]) / 2
    before = np.concatenate([[0.0], np.cumsum(parts)])
    goal = xi * before[-1]
    total = jnp.zeros_like(goal)
    for k, width in enumerate(widths):
        if parts[k] <= 0:
            total = total + jnp.where(goal >= before[k], width, 0.0)
            continue
        rest = jnp.minimum(jnp.maximum(goal - before[k], 0.0), parts[k])
        slope = (values[k + 1] - values[k]) / width
        root = jnp.sqrt(jnp.maximum(values[k] ** 2 + 2 * slope * rest, 0.0))
        total = total + 2 * rest / jnp.maximum(values[k] + root, LEAST)
    return jnp.minimum(total, 1.0)


def _blend_normal(mixture: _Mixture, first, second) -> tuple[Array, Array, Array]:
    along, rest = _chosen(mixture.share * jnp.ones_like(first), first)
    squared = jnp.where(along, _squared_sine(mixture.x, rest), _squared_sine(mixture.y, rest))
    sine, phi = jnp.sqrt(squared), _kepler_azimuth(along, second)
    return sine * jnp.cos(phi), sine * jnp.sin(phi), jnp.sqrt(1 - squared)


def _chosen(share, sample) -> tuple[Array, Array]:
    """Return whether `sample` < `share`, and a number that is uniform given that."""
    first = sample < share
    width = jnp.where(first, share, 1 - share)
    rest = jnp.where(first, sample, sample - share) / jnp.maximum(width, LEAST)
    return first, jnp.minimum(jnp.maximum(rest, 0.0), 1.0)


def _kepler_azimuth(along, sample) -> Array:
    """Return φ with the density cos²φ/π if `along`, else sin²φ/π.

    M = 2φ solves M ± sin M = 4π·sample. On a half period that is y − sin y = g, with y = M or
    y = π − M.
    """
    turns = 2 * sample
    whole = jnp.floor(turns)
    part = turns - whole
    late = part > 0.5
    folded = 2 * np.pi * jnp.where(late, 1 - part, part)
    goal = jnp.maximum(jnp.where(along, np.pi - folded, folded), 0.0)
    # y³/6 is above y − sin y, which is convex: Newton's steps go beyond the root, and then back.
    y = jnp.minimum(jnp.power(jnp.maximum(6 * goal, LEAST), 1 / 3), np.pi)
    for _ in range(_KEPLER_STEPS):
        y2 = y * y
        near = 1 / 5040 - y2 * (1 / 362880 - y2 * (1 / 39916800 - y2 / 6227020800))
        near = y * y2 * (1 / 6 - y2 * (1 / 120 - y2 * near))
        value = jnp.where(y < 1, near, y - jnp.sin(y))
        slope = 2 * jnp.sin(y / 2) * jnp.sin(y / 2)
        y = jnp.minimum(y - (value - goal) / jnp.maximum(slope, LEAST), np.pi)
    angle = jnp.where(along, np.pi - y, y)
    angle = jnp.where(late, 2 * np.pi - angle, angle)
    return np.pi * whole + angle / 2


def _visible_normal(places: Places, x, y, z, first, second) -> tuple[Array, Array, Array]:
    view, azimuth = view_of(z), _azimuth_of(x, y)
    below = areas_below(places, view)
    goal = first * below[0][-1]
    drop = drawn_drop(segment_at(places, below, goal), view, goal)
    sine, u = _sides(drop)
    return _turned(sine, u, azimuth, drawn_azimuth(sine, u, view, second))


def _blend_visible_normal(mixture: _Mixture, x, y, z, first, second) -> tuple[Array, Array, Array]:
    azimuth = _azimuth_of(x, y)
    doubled = _doubled(*azimuth)
    one, other = view_of(z, doubled[0]), view_of(z, -doubled[0])
    below_x, below_y = areas_below(mixture.x, one), areas_below(mixture.y, other)
    seen_x, seen_y = mixture.share * below_x[0][-1], mixture.rest * below_y[0][-1]
    along, rest = _chosen(seen_x / (seen_x + seen_y), first)
    goal = rest * jnp.where(along, below_x[0][-1], below_y[0][-1])
    segment = either(
        along, segment_at(mixture.x, below_x, goal), segment_at(mixture.y, below_y, goal)
    )
    sign = jnp.where(along, 1.0, -1.0)
    view = view_of(z, sign * doubled[0])
    sine, u = _sides(drawn_drop(segment, view, goal))
    psi = drawn_azimuth_of_blend(sine, u, view, sign, doubled, second)
    return _turned(sine, u, azimuth, psi)


def _sides(drop) -> tuple[Array, Array]:
    return jnp.sqrt(drop * (2 - drop)), 1 - drop


def _turned(sine, u, azimuth, psi) -> tuple[Array, Array, Array]:
    """Return the normal of sin θ and cos θ, at the azimuth ψ from that of o."""
    c, s = jnp.cos(psi), jnp.sin(psi)
    along, across = azimuth
    return sine * (along * c - across * s), sine * (across * c + along * s), u
