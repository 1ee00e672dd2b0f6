"""Random visible normals of an NDF that is linear in cos²θ, exactly and without rejection.

The density is D(m) max(o·m, 0)/(cos θo + H) per steradian. Integrated over azimuths, it has a
closed form: its part below θ is cos θo times the mass below θ plus the primitive of H
(`hidden_area`). So θ is found by the segment in which a given part ends, and then by the root of an
increasing function. The azimuth relative to o is the root of another one. A blend adds terms of
cos 2φ to both.
"""

import jax.numpy as jnp
from jax import Array
from jax.typing import ArrayLike
from jaxtyping import Float

from shading.directions import direction
from shading.piecewise.blend import Blend, weights
from shading.piecewise.hidden_area import beyond_edge, hidden_primitives, lean_primitives
from shading.piecewise.moments import masses, segment_mass
from shading.piecewise.ndf import Profile, coefficients, squared_sine_steps
from shading.piecewise.normal_sampling import choose, density_of_normal, segment_and_rest
from shading.piecewise.roots import increasing_root
from shading.sggx import reflect
from shading.types import Scalar, Vector


def sample_visible_normal(
    ndf: Profile | Blend, outgoing: Vector, sample: Float[ArrayLike, "2"]
) -> Array:
    """Draw a normal (3,) that is visible from the unit vector o = `outgoing`, with o_z > 0.

    `sample` is uniform in [0, 1)². Raises ValueError for profiles that are linear in the angle: the
    mass of their segments has no closed form.
    """
    sample = jnp.asarray(sample)
    theta_o, phi_o = _angles(outgoing)
    if isinstance(ndf, Profile):
        bend, first = jnp.zeros(()), sample[0]
        theta = _sample_polar_angle(ndf, theta_o, jnp.zeros(()), first)
    else:
        x, y, turn = _visible_parts(ndf, theta_o, phi_o)
        along, first = choose(x / (x + y), sample[0])
        bend = jnp.where(along, 1.0, -1.0)
        theta = jnp.where(
            along,
            _sample_polar_angle(ndf.x, theta_o, turn, first),
            _sample_polar_angle(ndf.y, theta_o, -turn, first),
        )
    return direction(theta, _sample_azimuth(theta, theta_o, phi_o, bend, sample[1]))


def visible_pdf(ndf: Profile | Blend, outgoing: Vector, normal: Vector) -> Array:
    """Return the density D(m) max(o·m, 0)/(cos θo + H) of visible normals, per steradian."""
    outgoing, normal = jnp.asarray(outgoing), jnp.asarray(normal)
    seen = jnp.maximum(outgoing @ normal, 0.0)
    return density_of_normal(ndf, normal) * seen / visible_area(ndf, outgoing)


def sample_reflection(
    ndf: Profile | Blend, outgoing: Vector, sample: Float[ArrayLike, "2"]
) -> Array:
    """Reflect o = `outgoing` about a visible normal: a direction (3,), which may be below z = 0."""
    return reflect(outgoing, sample_visible_normal(ndf, outgoing, sample))


def reflection_pdf(ndf: Profile | Blend, outgoing: Vector, incoming: Vector) -> Array:
    """Return the density of `sample_reflection` at i = `incoming`: D(h)/(4 (cos θo + H)).

    It is per steradian, over the whole sphere. h is the half vector if that is in the upper
    hemisphere; otherwise the density is 0.
    """
    outgoing, incoming = jnp.asarray(outgoing), jnp.asarray(incoming)
    half = outgoing + incoming
    squared = half @ half
    half = half / jnp.sqrt(jnp.where(squared > 0, squared, 1.0))
    above = half[2] > 0
    at = jnp.where(above, half, jnp.array([0.0, 0.0, 1.0]))
    return jnp.where(above, density_of_normal(ndf, at) / (4 * visible_area(ndf, outgoing)), 0.0)


def visible_area(ndf: Profile | Blend, outgoing: Vector) -> Array:
    """Return ∫ max(o·m, 0) D dω = cos θo + H for a normalised NDF, in closed form."""
    theta_o, phi_o = _angles(outgoing)
    if isinstance(ndf, Profile):
        return jnp.sum(_segment_areas(ndf, theta_o, jnp.zeros(())))
    x, y, _ = _visible_parts(ndf, theta_o, phi_o)
    return x + y


def visible_share(ndf: Blend, outgoing: Vector) -> Array:
    """Return the part of the visible area that D_x has, which decides the profile drawn from."""
    x, y, _ = _visible_parts(ndf, *_angles(outgoing))
    return x / (x + y)


def _angles(outgoing: Vector) -> tuple[Array, Array]:
    x, y, z = jnp.asarray(outgoing)
    across = x * x + y * y
    tilted = across > 0
    sine = jnp.where(tilted, jnp.sqrt(jnp.where(tilted, across, 1.0)), 0.0)
    return jnp.arctan2(sine, z), jnp.arctan2(y, jnp.where(tilted, x, 1.0))


def _visible_parts(ndf: Blend, theta_o: Array, phi_o: Array) -> tuple[Array, Array, Array]:
    """Return the visible areas of both parts of the mixture, and cos 2φo."""
    x, y = weights(ndf)
    turn = jnp.cos(2 * phi_o)
    seen_x = x * jnp.sum(_segment_areas(ndf.x, theta_o, turn))
    seen_y = y * jnp.sum(_segment_areas(ndf.y, theta_o, -turn))
    return seen_x, seen_y, turn


def _segment_areas(ndf: Profile, theta_o: Array, turn: Array) -> Array:
    """Return the visible area of each segment, (n − 1,)."""
    if ndf.variable != "cos2":
        raise ValueError("visible normals are drawn from profiles that are linear in 'cos2' only")
    a, b = coefficients(ndf)
    for_a, for_b = _primitives(ndf.knots, theta_o, turn)
    hidden = a * jnp.diff(for_a) + b * jnp.diff(for_b)
    return jnp.maximum(jnp.cos(theta_o) * masses(ndf) + hidden, 0.0)


def _primitives(theta: Array, theta_o: Array, turn: Array) -> tuple[Array, Array]:
    u, rim = beyond_edge(theta, theta_o)
    for_a, for_b = hidden_primitives(u, rim, theta_o)
    lean_a, lean_b = lean_primitives(u, rim, theta_o)
    return for_a + turn * lean_a, for_b + turn * lean_b


def _sample_polar_angle(ndf: Profile, theta_o: Array, turn: Array, sample: Scalar) -> Array:
    k, rest = segment_and_rest(_segment_areas(ndf, theta_o, turn), sample)
    a, b = coefficients(ndf)
    ends = (ndf.knots[k], ndf.knots[k + 1], ndf.values[k], ndf.values[k + 1], a[k], b[k])

    def area(theta, parameters):
        (left, right, low, high, level, bend), theta_o, turn = parameters
        part = squared_sine_steps(left, theta) / squared_sine_steps(left, right)
        value = low + (high - low) * part
        before, after = (_primitives(each, theta_o, turn) for each in (left, theta))
        found = jnp.cos(theta_o) * segment_mass("cos2", left, theta, low, value)
        found = found + level * (after[0] - before[0]) + bend * (after[1] - before[1])
        return found, value * jnp.sin(theta) * _ring(theta, theta_o, turn)

    return increasing_root(area, (ends, theta_o, turn), rest, ends[0], ends[1])


def _ring(theta: Array, theta_o: Array, turn: Array) -> Array:
    """Return ∫ max(o·m, 0) (1 ± cos 2φ) dφ at a polar angle; `turn` is ±cos 2φo."""
    u, rim = beyond_edge(theta, theta_o)
    height = jnp.cos(theta_o) * jnp.cos(theta)
    opened = jnp.where(rim > 0, jnp.arctan2(rim, jnp.cos(theta_o) * jnp.where(rim > 0, u, 1.0)), 0)
    across = jnp.sin(theta_o) * jnp.sin(theta)
    lean = turn * 2 / 3 * rim**3 / jnp.where(across > 0, across, 1.0) ** 2
    return 2 * jnp.pi * height + 2 * (rim - height * opened) + lean


def _sample_azimuth(theta: Array, theta_o: Array, phi_o: Array, bend: Array, sample: Scalar):
    """Return φ with a density proportional to max(o·m, 0) (1 + bend·cos 2φ) at a polar angle."""
    across = jnp.sin(theta_o) * jnp.sin(theta)
    height = jnp.cos(theta_o) * jnp.cos(theta)
    u, rim = beyond_edge(theta, theta_o)
    facing = jnp.where(rim > 0, rim, 1.0)
    limit = jnp.pi - jnp.where(rim > 0, jnp.arctan2(facing, jnp.cos(theta_o) * u), 0.0)

    def turned(psi, parameters):
        across, height, phi_o, bend = parameters
        first, second, third = (2 * phi_o + k * psi for k in (1, 2, 3))
        tilt = across * (jnp.sin(third) / 6 + jnp.sin(first) / 2) + height * jnp.sin(second) / 2
        value = across * jnp.sin(psi) + height * psi + bend * tilt
        slope = (across * jnp.cos(psi) + height) * (1 + bend * jnp.cos(second))
        return value, slope

    parameters = (across, height, phi_o, bend)
    low, high = (turned(sign * limit, parameters)[0] for sign in (-1, 1))
    psi = increasing_root(turned, parameters, low + (high - low) * sample, -limit, limit)
    return phi_o + psi
