"""Random normals with the density D(m) (n·m) of a piecewise-linear NDF, per steradian.

A blend is a mixture: one of its profiles is chosen, then θ by the CDF of that profile alone, then φ
with the density cos²φ/π or sin²φ/π. So no table depends on φ, which the paper's conditional CDF
needs (Eq. 9), and no step depends on a tolerance, which its Algorithm 2 misses in float32.
"""

import jax.numpy as jnp
from jax import Array
from jax.typing import ArrayLike
from jaxtyping import Float

from shading.directions import direction
from shading.piecewise.blend import Blend, blend_density, weights
from shading.piecewise.moments import masses, segment_mass
from shading.piecewise.ndf import Profile, density, squared_sine_steps
from shading.piecewise.roots import increasing_root
from shading.types import Scalar, Vector


def sample_normal(ndf: Profile | Blend, sample: Float[ArrayLike, "2"]) -> Array:
    """Draw a normal (3,) with the density D(m) (n·m). `sample` is uniform in [0, 1)²."""
    sample = jnp.asarray(sample)
    if isinstance(ndf, Profile):
        return direction(sample_polar_angle(ndf, sample[0]), 2 * jnp.pi * sample[1])
    along, first = choose(weights(ndf)[0], sample[0])
    theta = jnp.where(along, sample_polar_angle(ndf.x, first), sample_polar_angle(ndf.y, first))
    return direction(theta, sample_azimuth(jnp.where(along, 1.0, -1.0), sample[1]))


def normal_pdf(ndf: Profile | Blend, normal: Vector) -> Array:
    """Return the density D(m) max(n·m, 0) of `sample_normal`, per steradian."""
    normal = jnp.asarray(normal)
    return density_of_normal(ndf, normal) * jnp.maximum(normal[2], 0.0)


def density_of_normal(ndf: Profile | Blend, normal: Vector) -> Array:
    """Return D(m), per steradian, of a unit vector m = `normal` in the upper hemisphere."""
    x, y, z = jnp.asarray(normal)
    across = x * x + y * y
    theta = jnp.arctan2(jnp.sqrt(jnp.where(across > 0, across, 1.0)), z)
    theta = jnp.where(across > 0, theta, 0.0)
    if isinstance(ndf, Profile):
        return density(ndf, theta)
    return blend_density(ndf, theta, jnp.arctan2(y, jnp.where(across > 0, x, 1.0)))


def sample_polar_angle(ndf: Profile, sample: Scalar) -> Array:
    """Return θ, of which the part `sample` in [0, 1) of the mass of D cos θ is below."""
    parts = masses(ndf)
    k, rest = segment_and_rest(parts, sample)
    left, right = ndf.knots[k], ndf.knots[k + 1]
    low, high = ndf.values[k], ndf.values[k + 1]
    if ndf.variable == "cos2":
        # With y = sin²θ − sin²θ_k the mass is π(low·y + slope·y²/2): a parabola.
        slope = (high - low) / squared_sine_steps(left, right)
        squared = low * low + 2 * slope * rest / jnp.pi
        root = jnp.sqrt(jnp.where(squared > 0, squared, 1.0))
        below = low + jnp.where(squared > 0, root, 0.0)
        y = jnp.where(below > 0, 2 * rest / jnp.pi / jnp.where(below > 0, below, 1.0), 0.0)
        y = jnp.clip(y, 0.0, squared_sine_steps(left, right))
        sine2 = jnp.sin(left) ** 2 + y
        cosine = jnp.sqrt(jnp.maximum(jnp.cos(left) ** 2 - y, 0.0))
        sine = jnp.sqrt(jnp.where(sine2 > 0, sine2, 1.0))
        return jnp.where(sine2 > 0, jnp.arctan2(sine, cosine), 0.0)

    def mass(theta, ends):
        start, end, first, last = ends
        value = first + (last - first) * (theta - start) / (end - start)
        found = segment_mass("angle", start, theta, first, value)
        return found, jnp.pi * value * jnp.sin(2 * theta)

    return increasing_root(mass, (left, right, low, high), rest, left, right)


def sample_azimuth(sign: Scalar, sample: Scalar) -> Array:
    """Return φ in [0, 2π] with the density cos²φ/π (`sign` 1) or sin²φ/π (`sign` −1).

    M = 2φ solves Kepler's equation M + sign·sin M = 4π·sample.
    """
    turn = 4 * jnp.pi * jnp.asarray(sample)
    periods = jnp.floor(turn / (2 * jnp.pi))

    def kepler(angle, bend):
        return angle + bend * jnp.sin(angle), 1 + bend * jnp.cos(angle)

    goal = turn - 2 * jnp.pi * periods
    angle = increasing_root(kepler, jnp.asarray(sign), goal, 0.0, 2 * jnp.pi)
    return jnp.pi * periods + angle / 2


def choose(share: Scalar, sample: Scalar) -> tuple[Array, Array]:
    """Return whether `sample` < `share`, and a number in [0, 1] that is uniform given that."""
    share, sample = jnp.asarray(share), jnp.asarray(sample)
    first = sample < share
    width = jnp.where(first, share, 1 - share)
    rest = jnp.where(first, sample, sample - share) / jnp.where(width > 0, width, 1.0)
    return first, jnp.clip(rest, 0.0, 1.0)


def segment_and_rest(parts: Array, sample: Scalar) -> tuple[Array, Array]:
    """Return the segment k in which the part `sample` of the mass ends, and what is left in it.

    `parts` (n − 1,) are the masses of the segments. A segment without mass is never chosen.
    """
    ends = jnp.cumsum(parts)
    goal = jnp.asarray(sample) * ends[-1]
    k = jnp.clip(jnp.searchsorted(ends, goal, side="right"), 0, parts.size - 1)
    before = jnp.where(k > 0, ends[jnp.maximum(k - 1, 0)], 0.0)
    return k, jnp.clip(goal - before, 0.0, parts[k])
