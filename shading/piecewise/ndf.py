"""An isotropic NDF that is given by its values at knots of the polar angle.

Between knots the NDF D(θ), per steradian, is linear in the angle θ, as Ribardière et al. define it
(*A Piecewise-Linear NDF*, Eq. 4), or linear in cos²θ, for which all integrals are elementary.
"""

from collections.abc import Sequence

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jax import Array
from jax.typing import ArrayLike
from jaxtyping import Float

# What the NDF is linear in between knots: the polar angle θ, or cos²θ.
VARIABLES = ("angle", "cos2")


class Profile(eqx.Module):
    """An isotropic NDF: `values` (n,), per steradian, at the polar angles `knots` (n,) in radians.

    The knots increase from 0 to π/2. `variable` says what D is linear in between them: "angle" (θ)
    or "cos2" (cos²θ). `profile` makes one from numbers that have to be checked.
    """

    knots: Float[Array, " n"] = eqx.field(converter=jnp.asarray)
    values: Float[Array, " n"] = eqx.field(converter=jnp.asarray)
    variable: str = eqx.field(static=True, default="angle")


def profile(
    knots: ArrayLike | Sequence[ArrayLike],
    values: ArrayLike | Sequence[ArrayLike],
    variable: str = "angle",
) -> Profile:
    """Return a checked profile of `values` (n,), per steradian, at `knots` (n,), in radians.

    The values are kept as they are; `moments.normalised` divides them by their mass. Raises
    ValueError for an unknown variable, for fewer than two knots, for knots that do not increase
    from 0 to π/2, and for values that are negative, not finite or all zero.
    """
    x, y = np.asarray(knots, float), np.asarray(values, float)
    if variable not in VARIABLES:
        raise ValueError(f"variable {variable!r}: allowed are {', '.join(VARIABLES)}")
    if x.ndim != 1 or len(x) < 2 or x.shape != y.shape:
        raise ValueError(
            f"knots of shape {x.shape} and values of shape {y.shape}: allowed are two arrays (n,) "
            "of the same n, at least 2"
        )
    if not (np.isfinite(x).all() and (np.diff(x) > 0).all()):
        raise ValueError("knots: allowed are finite angles that increase")
    if x[0] != 0 or abs(x[-1] - np.pi / 2) > 1e-12:
        raise ValueError(f"knots from {x[0]:g} to {x[-1]:g}: allowed are those from 0 to π/2")
    if not (np.isfinite(y).all() and (y >= 0).all() and y.any()):
        raise ValueError("values of the NDF: allowed are finite numbers ≥ 0 that are not all zero")
    x = x.copy()
    x[-1] = np.pi / 2
    return Profile(x, y, variable)


def uniform_knots(segments: int) -> np.ndarray:
    """Return `segments` + 1 equidistant angles from 0 to π/2, in radians.

    Raises ValueError for less than one segment.
    """
    if segments < 1:
        raise ValueError(f"segments = {segments}: allowed are 1 and more")
    return np.linspace(0, np.pi / 2, segments + 1)


def segment_of(ndf: Profile, theta: ArrayLike) -> Array:
    """Return k, for which the angle θ is between the knots k and k + 1, elementwise."""
    found = jnp.searchsorted(ndf.knots, jnp.asarray(theta), side="right") - 1
    return jnp.clip(found, 0, ndf.knots.size - 2)


def squared_sine_steps(lower: ArrayLike, upper: ArrayLike) -> Array:
    """Return sin²(upper) − sin²(lower) without cancellation, for angles in radians."""
    lower, upper = jnp.asarray(lower), jnp.asarray(upper)
    return jnp.sin(upper - lower) * jnp.sin(upper + lower)


def density(ndf: Profile, theta: ArrayLike) -> Array:
    """Return D(θ), per steradian, elementwise at angles θ in [0, π/2] (Eq. 4 for "angle")."""
    theta = jnp.asarray(theta)
    k = segment_of(ndf, theta)
    left, right = ndf.knots[k], ndf.knots[k + 1]
    if ndf.variable == "angle":
        part = (theta - left) / (right - left)
    else:
        part = squared_sine_steps(left, theta) / squared_sine_steps(left, right)
    return ndf.values[k] + (ndf.values[k + 1] - ndf.values[k]) * part


def coefficients(ndf: Profile) -> tuple[Array, Array]:
    """Return a and b (n − 1,) of each segment: D = aθ + b for "angle", D = a + b cos²θ else."""
    step = jnp.diff(ndf.values)
    if ndf.variable == "angle":
        a = step / jnp.diff(ndf.knots)
        return a, ndf.values[:-1] - a * ndf.knots[:-1]
    b = -step / squared_sine_steps(ndf.knots[:-1], ndf.knots[1:])
    return ndf.values[:-1] - b * jnp.cos(ndf.knots[:-1]) ** 2, b
