"""The projected area H of microfacets that face away, in closed form, for D linear in cos²θ.

On a segment D = a + bu² with u = cos θ. Let s = sin θo, c = cos θo, h = 1 − c = 2 sin²(θo/2) and
r = √(s² − u²). The integrand of H (`smith`) has a primitive that is zero at u = s:

    P(u) = a [A(h + cu²) − ur − c(1 − u²)δ] + b [A(h² + 2cu⁴) + ur(1 − 2u²) − 2c(1 − u⁴)δ] / 4,
    A = atan2(r, u),  δ = atan2(hur, cu² + r²).

A is the angle of the integration, and cA + hA + δ is the azimuth C. The formula has no difference
of nearly equal angles: for small θo, C and cA are nearly equal, and 1 − c is small. In the factor
of b, ur − 2cδ is what remains to cancel; it is ur h(h − u²)/z + 2c(x − atan x) with z = cu² + r²
and x = hur/z. It serves visible normals. At grazing light, where a narrow peak counts, P is much
smaller than its terms; H itself is therefore a sum over knots (`bend_areas`).
"""

import jax.numpy as jnp
from jax import Array
from jax.typing import ArrayLike

from shading.piecewise.bend_areas import bend_areas
from shading.piecewise.defects import tangent_defect
from shading.piecewise.ndf import Profile, squared_sine_steps
from shading.types import Scalar

# Below this ratio x the two terms of ur − 2cδ are taken together.
_TOGETHER = 0.4


def hidden_primitives(u: ArrayLike, rim: ArrayLike, theta_o: Scalar) -> tuple[Array, Array]:
    """Return the factors of a and of b in P(u), elementwise.

    `u` is cos θ ≤ sin θo, and `rim` is r = √(sin²θo − u²), which the caller knows without
    cancellation.
    """
    u, rim, theta_o = (jnp.asarray(each) for each in (u, rim, theta_o))
    c, h = jnp.cos(theta_o), 2 * jnp.sin(theta_o / 2) ** 2
    u2, chord = u * u, u * rim
    z = c * u2 + rim * rim
    opened, delta = _angle(rim, u), _angle(h * chord, z)
    for_a = opened * (h + c * u2) - chord - c * (1 - u2) * delta
    together = h * chord < _TOGETHER * z
    safe = jnp.where(together, z, 1.0)
    x = jnp.where(together, h * chord / safe, 0.0)
    near = chord * h * (h - u2) / safe + 2 * c * tangent_defect(x)
    pair = jnp.where(together, near, chord - 2 * c * delta)
    rest = opened * (h * h + 2 * c * u2 * u2) - 2 * chord * u2 + 2 * c * u2 * u2 * delta
    return for_a, (rest + pair) / 4


def lean_primitives(u: ArrayLike, rim: ArrayLike, theta_o: Scalar) -> tuple[Array, Array]:
    """Return the factors of a and of b in the primitive of a blend's additional term, elementwise.

    With the density 1 ± cos 2φ of azimuths, ±cos 2φo times this is added to P(u). It is the
    primitive of (2/3) (s² − u²)^{3/2}/(s²(1 − u²)). Its error is absolute, about 1e-16: it cancels
    for small θo, where it is much smaller than P itself.
    """
    u, rim, theta_o = (jnp.asarray(each) for each in (u, rim, theta_o))
    c, h, s2 = jnp.cos(theta_o), 2 * jnp.sin(theta_o / 2) ** 2, jnp.sin(theta_o) ** 2
    scale = jnp.where(s2 > 0, s2, 1.0)
    opened = _angle(rim, u)
    chord = u * rim / scale
    delta = _angle(h * u * rim, c * u * u + rim * rim)
    whole = (opened - chord) / 2 + c * c * (c * delta / scale - opened / (1 + c))
    # ∫ sin⁴A dA, where sin²A = r²/s²
    fourth = 3 * opened / 8 - chord * (3 + 2 * rim * rim / scale) / 8
    tilted = s2 > 0
    for_a = jnp.where(tilted, 2 / 3 * whole, 0.0)
    return for_a, jnp.where(tilted, 2 / 3 * (whole - s2 * fourth), 0.0)


def hidden_area_closed(ndf: Profile, theta_o: Scalar) -> Array:
    """Return H = ∫ max(−o·m, 0) D dω of a profile that is linear in cos²θ, for θo in [0, π/2].

    Raises ValueError for a profile that is linear in the angle: its integral is a dilogarithm.
    """
    if ndf.variable != "cos2":
        raise ValueError("the closed form is for profiles that are linear in 'cos2' only")
    slopes = -jnp.diff(ndf.values) / squared_sine_steps(ndf.knots[:-1], ndf.knots[1:])
    u, rim = beyond_edge(ndf.knots[1:-1], theta_o)
    bends = -jnp.diff(slopes) * bend_areas(u, rim, theta_o)
    # What the values and the slope at the horizon add, where u = 0 and A = π/2.
    h = 2 * jnp.sin(jnp.asarray(theta_o) / 2) ** 2
    area = jnp.pi / 2 * h * (ndf.values[-1] + slopes[-1] / 4 * h) + jnp.sum(bends)
    # H is an integral of what is nowhere negative: below zero there is only rounding.
    return jnp.maximum(area, 0.0)


def beyond_edge(theta: ArrayLike, theta_o: Scalar) -> tuple[Array, Array]:
    """Return u = min(cos θ, sin θo) and r = √(sin²θo − u²) without cancellation, elementwise.

    Normals with cos θ < sin θo are those that can face away from a direction at θo.
    """
    theta, theta_o = jnp.asarray(theta), jnp.asarray(theta_o)
    elevation = jnp.pi / 2 - theta
    squared = jnp.sin(theta_o - elevation) * jnp.sin(theta_o + elevation)
    beyond = (theta_o > elevation) & (squared > 0)
    rim = jnp.where(beyond, jnp.sqrt(jnp.where(beyond, squared, 1.0)), 0.0)
    return jnp.where(beyond, jnp.sin(elevation), jnp.sin(theta_o)), rim


def _angle(y: Array, x: Array) -> Array:
    """Return atan2(y, x) for y, x ≥ 0, which is 0 at the origin with finite derivatives."""
    none = (x == 0) & (y == 0)
    return jnp.where(none, 0.0, jnp.arctan2(y, jnp.where(none, 1.0, x)))
