"""Visible normals as straight-line code: a segment by its closed mass, then a bracketed root.

Let F(θ) be the projected area of the visible normals below θ, which is all of it at π/2. With the
kernels B and T of `code_kernels` and the mass M(θ) below θ,

    F(θ) = cos θo M(θ) + D(θ) B(θ) + (slope at θ) T(θ) + Σ (bend at a knot) T(knot),

summed over the knots below θ. So no term is a difference of areas.
"""

from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from jax import Array

from quantities.piecewise.code_kernels import (
    LEAST,
    Places,
    View,
    angle,
    kernels,
    ring,
)

# Steps of bracketed roots. After as many, F is within 1e-6 of what is wanted for profiles without
# narrow peaks, and within 3e-5 for GGX of width 0.1 (tests).
POLAR_STEPS, AZIMUTH_STEPS, BLEND_STEPS = 7, 6, 16
# In units of the first bracket: what rounding may move a step of Newton out of a later one.
_MARGIN = 1e-5


def areas_below(places: Places, view: View) -> tuple[list[Array], list[Array]]:
    """Return F at each knot, and the sum of bends times T over the inner knots up to it."""
    areas, sums = [jnp.zeros_like(view.cosine)], [jnp.zeros_like(view.cosine)]
    for k in range(1, len(places.cosines)):
        u = places.cosines[k]
        last = k == len(places.cosines) - 1
        found = kernels(jnp.zeros_like(view.cosine) if last else u, view)
        hidden = places.values[k] * found.level + places.slopes[k - 1] * found.bent
        areas.append(view.cosine * places.below[k] + (hidden + sums[-1]))
        if not last:
            sums.append(sums[-1] + places.bends[k - 1] * found.bent)
    return areas, sums


class Segment(NamedTuple):
    """The segment in which F reaches a goal: the drops 1 − cos θ of its ends, D and so on.

    `value`, `slope`, `mass` and `square` are D, its slope, the mass and sin²θ where it begins, and
    `width` the step of sin²θ. `bent` is the sum over earlier bends, and `first` and `second` are F
    at both ends.
    """

    low: Array
    high: Array
    value: Array
    slope: Array
    mass: Array
    square: Array
    width: Array
    bent: Array
    first: Array
    second: Array


def segment_at(places: Places, below: tuple[list[Array], list[Array]], goal: Array) -> Segment:
    """Return the segment in which the area reaches the goal; `below` is that of `areas_below`."""
    areas, sums = below
    fixed = np.stack(
        [
            *(places.drops[:-1], places.drops[1:], places.values[:-1], places.slopes),
            *(places.below[:-1], places.squares[:-1], np.diff(places.squares)),
        ]
    )

    def at(k: int) -> Segment:
        constants = (jnp.asarray(each) * jnp.ones_like(goal) for each in fixed[:, k])
        return Segment(*constants, sums[k], areas[k], areas[k + 1])

    found = at(0)
    for k in range(1, len(places.slopes)):
        found = either(goal >= areas[k], at(k), found)
    return found


def either(first: Array, one: Segment, other: Segment) -> Segment:
    """Return `one` if `first`, else `other`."""
    return Segment(*(jnp.where(first, a, b) for a, b in zip(one, other, strict=True)))


def drawn_drop(segment: Segment, view: View, goal: Array) -> Array:
    """Return 1 − cos θ in a segment, below which the visible area is the goal."""
    low, high, value, slope, mass, square, width, bent, first, second = segment

    def area(drop):
        u, flat = 1 - drop, drop * (2 - drop)
        step = (drop - low) * (2 - drop - low)
        found = kernels(u, view)
        density = value - slope * step
        own = np.pi * step * (value - slope / 2 * step)
        hidden = density * found.level + (slope * found.bent + bent)
        total = view.cosine * (mass + own) + hidden
        return total, density * ring(u, flat, found, view)

    # The first guess is where the mass without the weight max(o·m, 0) has the same part.
    part = (goal - first) / jnp.maximum(second - first, LEAST)
    part = jnp.minimum(jnp.maximum(part, 0.0), 1.0)
    end = value - slope * width
    root = jnp.sqrt(jnp.maximum(value * value + (end - value) * (end + value) * part, 0.0))
    step = width * part * (value + end) / jnp.maximum(value + root, LEAST)
    squared = jnp.minimum(square + step, 1.0)
    guess = squared / (1 + jnp.sqrt(1 - squared))
    guess = jnp.minimum(jnp.maximum(guess, low), high)
    return bracketed(area, goal, low, high, guess, POLAR_STEPS)


def bracketed(of, goal: Array, low: Array, high: Array, guess: Array, steps: int) -> Array:
    """Return x with of(x)[0] = goal for an increasing function, whose slope is of(x)[1].

    Each step is Newton's, or a bisection where that would leave the bracket by more than rounding
    does: near the root, compilers that fuse operations may find its sign and its size differently.
    """
    x, margin = guess, _MARGIN * (high - low)
    for _ in range(steps):
        value, slope = of(x)
        gap = value - goal
        low, high = jnp.where(gap <= 0, x, low), jnp.where(gap <= 0, high, x)
        moved = x - gap / jnp.where(slope > 0, slope, LEAST)
        inside = (moved >= low - margin) & (moved <= high + margin)
        held = jnp.minimum(jnp.maximum(moved, low), high)
        x = jnp.where(inside, held, (low + high) / 2)
    return x


def drawn_azimuth(sine: Array, u: Array, view: View, xi: Array) -> Array:
    """Return ψ, the azimuth relative to o, with a density proportional to max(o·m, 0).

    sin θo sin θ sin ψ + cos θo cos θ ψ is (2 xi − 1) times its value at the end of the arc.
    """
    across, height = view.sine * sine, view.cosine * u
    limit = arc(u, view)
    whole = across * jnp.sin(limit) + height * limit
    part = 2 * xi - 1
    goal = jnp.abs(part) * whole
    # The first guess is that of a parabola with the slope at 0 and the value at the end.
    slope = across + height
    bend = (slope * limit - whole) / (limit * limit)
    root = jnp.sqrt(jnp.maximum(slope * slope - 4 * bend * goal, 0.0))
    guess = jnp.minimum(2 * goal / jnp.maximum(slope + root, LEAST), limit)

    def turned(psi):
        return across * jnp.sin(psi) + height * psi, across * jnp.cos(psi) + height

    psi = bracketed(turned, goal, jnp.zeros_like(limit), limit, guess, AZIMUTH_STEPS)
    return jnp.where(part < 0, -psi, psi)


def arc(u: Array, view: View) -> Array:
    """Return half the arc of the azimuths at the cosine u from which normals are visible."""
    rim = jnp.sqrt(jnp.maximum((view.sine - u) * (view.sine + u), 0.0))
    return np.pi - jnp.where(rim > 0, angle(rim, view.cosine * u), 0.0)


def drawn_azimuth_of_blend(
    sine: Array, u: Array, view: View, bend: Array, doubled: tuple[Array, Array], xi: Array
) -> Array:
    """Return ψ with a density proportional to max(o·m, 0) (1 + bend cos 2(φo + ψ)).

    `doubled` is the cosine and the sine of 2φo.
    """
    across, height = view.sine * sine, view.cosine * u
    limit = arc(u, view)
    cosine2, sine2 = doubled

    def turned(psi):
        s, c = jnp.sin(psi), jnp.cos(psi)
        s2, c2 = 2 * s * c, 1 - 2 * s * s
        s3, c3 = s * (3 - 4 * s * s), c * (1 - 4 * s * s)
        tilt = across * (
            (sine2 * c3 + cosine2 * s3) / 6 + (sine2 * c + cosine2 * s) / 2
        ) + height * ((sine2 * c2 + cosine2 * s2) / 2)
        value = across * s + height * psi + bend * tilt
        return value, (across * c + height) * (1 + bend * (cosine2 * c2 - sine2 * s2))

    first, last = turned(-limit)[0], turned(limit)[0]
    goal = first + (last - first) * xi
    return bracketed(turned, goal, -limit, limit, jnp.zeros_like(limit), BLEND_STEPS)
