"""A fitted NDF as functions for shaders: its value, the hidden area H, and a sampler.

The functions are straight-line: every knot contributes a term, which is zero where it should not
count. So the code has neither loops, nor searches, nor textures; its knots are constants.
"""

import jax.numpy as jnp
import numpy as np
from jax import Array

from programs import Function, Parameter, function
from shading.piecewise.ndf import Profile

# The arctangent of 0 to 1 is t times a polynomial of t², Abramowitz and Stegun 4.4.49, to 2e-8
# relative. Those of shading languages may be wrong by thousands of units in the last place, and the
# differences of angles below would magnify that.
_ARCTANGENT = (
    *(1.0, -0.3333314528, 0.1999355085, -0.1420889944, 0.1065626393),
    *(-0.0752896400, 0.0429096138, -0.0161657367, 0.0028662257),
)
# Divisors of the sampler are at least this; it only counts where D is zero at both ends.
_LEAST = 1e-30


def ndf_functions(ndf: Profile, name: str = "Ndf") -> tuple[Function, ...]:
    """Return the functions of an NDF that is linear in cos²θ, whose names begin with `name`.

    * `{name}D(NdotH)`: D, per steradian.
    * `{name}Hidden(NdotV)`: H = Λ·NdotV, of the view, and of the light.
    * `{name}Visibility(NdotV, hiddenV, NdotL, hiddenL)`: G2/(4 NdotV NdotL) from both H.
    * `{name}SquaredSine(xi)`: sin²θ of a normal with the density D cos θ, from xi in [0, 1].

    Raises ValueError for an NDF that is linear in the angle, whose H has no closed form.
    """
    if ndf.variable != "cos2":
        raise ValueError("code is written for NDFs that are linear in 'cos2' only")
    cosine = (0.0, 1.0)
    hidden = (0.0, 2.0)
    return (
        function(
            f"{name}D",
            (Parameter("NdotH", cosine),),
            lambda NdotH: _density(ndf, NdotH),
            "Return D, the density of normals per steradian.",
        ),
        function(
            f"{name}Hidden",
            (Parameter("NdotV", cosine),),
            lambda NdotV: _hidden(ndf, NdotV),
            "Return Lambda * NdotV, the projected area of normals that face away.",
        ),
        function(
            f"{name}Visibility",
            (
                Parameter("NdotV", (1e-3, 1.0)),
                Parameter("hiddenV", hidden),
                Parameter("NdotL", (1e-3, 1.0)),
                Parameter("hiddenL", hidden),
            ),
            _visibility,
            "Return the height-correlated G2 / (4 NdotV NdotL).",
        ),
        function(
            f"{name}SquaredSine",
            (Parameter("xi", (0.0, 1.0)),),
            lambda xi: _squared_sine(ndf, xi),
            "Return the squared sine of a random normal's angle, from xi in [0, 1].",
        ),
    )


def _places(ndf: Profile) -> tuple[np.ndarray, np.ndarray]:
    """Return sin²θ of the knots and the values there, as constants."""
    return np.sin(np.asarray(ndf.knots)) ** 2, np.asarray(ndf.values)


def _density(ndf: Profile, cosine) -> Array:
    x, values = _places(ndf)
    squared = (1 - cosine) * (1 + cosine)
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


def _hidden(ndf: Profile, cosine) -> Array:
    # notation: A, C, u, r = rim, s and c as in shading.piecewise.hidden_area. D is a sum of
    # max(u² − u_k², 0) times the changes of its slope, and each knot has the term
    #   A(h²/4 − h u² − c u⁴/2) + u r (1 + 2u²)/4 − (c/2)(1 − u²)² δ.
    x, values = _places(ndf)
    slopes = -np.diff(values) / np.diff(x)
    heights = np.cos(np.asarray(ndf.knots))
    heights[-1] = 0.0
    c, h = cosine, 1 - cosine
    s2 = h * (1 + c)
    sine = jnp.sqrt(s2)
    # The last knot is at u = 0, where C = A = π/2: what is constant, and linear in u².
    total = np.pi / 2 * h * (values[-1] + slopes[-1] / 4 * h)
    for k in range(1, len(x) - 1):
        u, bend = heights[k], slopes[k - 1] - slopes[k]
        u2 = u * u
        rim2 = jnp.maximum((sine - u) * (sine + u), 0.0)
        rim = jnp.sqrt(rim2)
        opened = _angle(rim, u)
        chord = u * rim
        delta = _angle(h * chord, c * u2 + rim2)
        level = h * (h / 4 - u2) - c * (u2 * u2 / 2)
        term = opened * level + chord * ((1 + 2 * u2) / 4) - c * ((1 - u2) ** 2 / 2) * delta
        total = total + bend * term
    return jnp.maximum(total, 0.0)


def _angle(y, x) -> Array:
    """Return atan2(y, x) for y, x ≥ 0; 0 at the origin."""
    t = jnp.minimum(x, y) / jnp.maximum(jnp.maximum(x, y), _LEAST)
    squared = t * t
    total = jnp.asarray(_ARCTANGENT[-1])
    for coefficient in _ARCTANGENT[-2::-1]:
        total = coefficient + squared * total
    near = t * total
    return jnp.where(y > x, np.pi / 2 - near, near)


def _visibility(NdotV, hiddenV, NdotL, hiddenL) -> Array:
    return 0.25 / (NdotV * NdotL + hiddenV * NdotL + hiddenL * NdotV)


def _squared_sine(ndf: Profile, xi) -> Array:
    x, values = _places(ndf)
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
        total = total + 2 * rest / jnp.maximum(values[k] + root, _LEAST)
    return jnp.minimum(total, 1.0)
