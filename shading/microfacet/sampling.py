"""Four ways to draw reflections of a GGX surface with the density of its visible normals.

Each maps a view o and random numbers that are uniform in [0, 1) to a light i, whose density is
D(h)/(4N) per steradian. h is the half vector. N is the projected area of the normals that the
sampler draws from, `projected_areas`: the smaller it is, the smaller is the variance.

* `sample_disk`: all visible normals, by a disk (Heitz 2018, "Sampling the GGX distribution of
  visible normals").
* `sample_cap`: the same normals, by a spherical cap (Dupuy and Benyoub 2023, "Sampling visible GGX
  normals with spherical caps").
* `sample_bounded_cap`: a smaller cap (Eto and Tokuyoshi 2023, "Bounded VNDF sampling for Smith-GGX
  reflections"; Tokuyoshi and Eto 2024).
* `sample_upper`: just the normals whose reflections are above the horizon. It draws no other
  reflection, while those of the first three may be below the horizon and are lost there. It takes a
  third random number.

Vectors are in the frame of the surface, whose z axis is the normal n. `alpha` is the width of GGX
as in `shading.microfacet.ggx`: a scalar or (αx, αy), positive, which may be above one.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp
from jax import Array
from jaxtyping import Float

from shading.microfacet.ggx import Roughness
from shading.microfacet.reflection_cone import (
    FLOAT64_STEPS,
    ReflectionCone,
    components,
    cone_of,
    upper_area,
)
from shading.types import Scalar, Vector

Numbers = Float[Array, "2"]
ThreeNumbers = Float[Array, "3"]


class ProjectedAreas(NamedTuple):
    """The projected areas N of the densities D(h)/(4N), and that of the upward reflections.

    `visible` is that of `sample_disk` and `sample_cap`, `bounded` that of `sample_bounded_cap`, and
    `upper` that of `sample_upper`. The fraction of the reflections that are above the horizon is
    `upper`/N.
    """

    visible: Array
    bounded: Array
    upper: Array


def projected_areas(view: Vector, alpha: Roughness) -> ProjectedAreas:
    """Return the projected areas N of the samplers for o = `view`, a unit vector with o·n ≥ 0."""
    given = components(view, alpha)
    sigma, height = stretched_length(*given), given[2]
    bounded = (sigma + cap_bound(*given) * height) / 2
    return ProjectedAreas((sigma + height) / 2, bounded, upper_area(cone_of(*given, FLOAT64_STEPS)))


def reflection_density(distribution: Scalar, projected_area: Scalar) -> Array:
    """Return the density D(h)/(4N) of a sampler's reflections, per steradian.

    `distribution` is D(h), and `projected_area` is N.
    """
    return jnp.asarray(distribution) / (4 * jnp.asarray(projected_area))


def sample_disk(view: Vector, alpha: Roughness, sample: Numbers) -> Array:
    """Return a light (3,): o = `view` reflected about any visible normal, by Heitz' disk.

    `view` is a unit vector, on either side of the surface. `sample` is uniform in [0, 1)².
    """
    return jnp.stack(disk_light(*components(view, alpha), *sample))


def sample_cap(view: Vector, alpha: Roughness, sample: Numbers) -> Array:
    """Return a light (3,): o = `view` reflected about any visible normal, by a spherical cap.

    `view` is a unit vector, on either side of the surface. `sample` is uniform in [0, 1)².
    """
    return jnp.stack(cap_light(*components(view, alpha), *sample, 1.0))


def sample_bounded_cap(view: Vector, alpha: Roughness, sample: Numbers) -> Array:
    """Return a light (3,): o = `view` reflected about a visible normal, by the bounded cap.

    `view` is a unit vector, on either side of the surface. `sample` is uniform in [0, 1)².
    """
    given = components(view, alpha)
    return jnp.stack(cap_light(*given, *sample, cap_bound(*given)))


def sample_upper(view: Vector, alpha: Roughness, sample: ThreeNumbers) -> Array:
    """Return a light (3,) above the horizon: o = `view` reflected about a visible normal.

    `view` is a unit vector with o·n ≥ 0. `sample` is uniform in [0, 1)³; the third number only
    makes one choice. The cosine i·n is positive in any precision.
    """
    given = components(view, alpha)
    return jnp.stack(upper_light(*given, *sample, cone_of(*given, FLOAT64_STEPS)))


def stretched_length(x: Array, y: Array, z: Array, alpha_x: Array, alpha_y: Array) -> Array:
    """Return σ(ω) = √(αx²x² + αy²y² + z²) of ω = (x, y, z)."""
    a, b = alpha_x * x, alpha_y * y
    return jnp.sqrt(a * a + b * b + z * z)


def cap_bound(x: Array, y: Array, z: Array, alpha_x: Array, alpha_y: Array) -> Array:
    """Return k of the bounded cap z ≥ −k ẑ_z for the view (x, y, z); below the horizon it is 1.

    k = (1 − a²)S²/(S² + a²μ²), S = 1 + √(x² + y²), a = min(1, αx, αy) (Eto and Tokuyoshi 2023).
    """
    reach = 1 + jnp.sqrt(x * x + y * y)
    a = jnp.minimum(jnp.minimum(alpha_x, alpha_y), 1.0)
    reach2, a2 = reach * reach, a * a
    bound = (1 - a) * (1 + a) * reach2 / (reach2 + a2 * z * z)
    return jnp.where(z > 0, bound, 1.0)


def disk_light(
    x: Array, y: Array, z: Array, alpha_x: Array, alpha_y: Array, first: Array, second: Array
) -> tuple[Array, Array, Array]:
    """Return the three components of the light of `sample_disk`."""
    sigma = stretched_length(x, y, z, alpha_x, alpha_y)
    stretched = (alpha_x * x / sigma, alpha_y * y / sigma, z / sigma)
    # The first tangent is horizontal. At normal incidence any horizontal vector is right.
    level2 = stretched[0] * stretched[0] + stretched[1] * stretched[1]
    level = jnp.where(level2 > 0, 1 / jnp.sqrt(jnp.where(level2 > 0, level2, 1.0)), 0.0)
    a, b = jnp.where(level2 > 0, -stretched[1] * level, 1.0), stretched[0] * level
    c, d, e = -stretched[2] * b, stretched[2] * a, stretched[0] * b - stretched[1] * a
    radius, angle = jnp.sqrt(first), 2 * jnp.pi * second
    across, along = radius * jnp.cos(angle), radius * jnp.sin(angle)
    half = (1 + stretched[2]) / 2
    along = (1 - half) * jnp.sqrt(jnp.maximum(1 - across * across, 0.0)) + half * along
    up = jnp.sqrt(jnp.maximum(1 - across * across - along * along, 0.0))
    return _reflected(
        (x, y, z),
        alpha_x * (across * a + along * c + up * stretched[0]),
        alpha_y * (across * b + along * d + up * stretched[1]),
        along * e + up * stretched[2],
    )


def cap_light(
    x: Array,
    y: Array,
    z: Array,
    alpha_x: Array,
    alpha_y: Array,
    first: Array,
    second: Array,
    bound: Array | float,
) -> tuple[Array, Array, Array]:
    """Return the light of `sample_cap` (`bound` = 1), or of `sample_bounded_cap` (`cap_bound`)."""
    sigma = stretched_length(x, y, z, alpha_x, alpha_y)
    stretched = (alpha_x * x / sigma, alpha_y * y / sigma, z / sigma)
    # The cap is that of heights above −k ẑ_z.
    height = 1 - first * (1 + bound * stretched[2])
    level = jnp.sqrt(jnp.maximum(1 - height * height, 0.0))
    angle = 2 * jnp.pi * second
    return _reflected(
        (x, y, z),
        alpha_x * (level * jnp.cos(angle) + stretched[0]),
        alpha_y * (level * jnp.sin(angle) + stretched[1]),
        height + stretched[2],
    )


def upper_light(
    x: Array,
    y: Array,
    z: Array,
    alpha_x: Array,
    alpha_y: Array,
    first: Array,
    second: Array,
    third: Array,
    cone: ReflectionCone,
) -> tuple[Array, Array, Array]:
    """Return the three components of the light of `sample_upper`."""
    point = point_across(cone, first, second)
    sign = jnp.where((2 * third - 1) * point.along < point.lean, 1.0, -1.0)
    return light_of(cone, point, sign, (x, y, alpha_x, alpha_y), 1 - first)


class PointAcross(NamedTuple):
    """A point p = `along`·w + q of the cone, where q = (`x`, `y`, 0) − `back`·w is across w.

    The area that the view sees there is proportional to `along` + `lean`, and that at its mirror
    image `along`·w − q to `along` − `lean`.
    """

    x: Array
    y: Array
    back: Array
    along: Array
    lean: Array


def light_of(
    cone: ReflectionCone,
    point: PointAcross,
    sign: Array | float,
    given: tuple[Array, Array, Array, Array],
    remaining: Array,
) -> tuple[Array, Array, Array]:
    """Return the light of a point of the cone (`sign` = 1), or of its mirror image (`sign` = −1).

    `given` is ox, oy, αx, αy. `remaining` is one minus the first random number. The height of the
    light is λ·remaining/|Mp|², because pᵀCp = λ·remaining. So rounding cannot make it negative.
    """
    x, y, alpha_x, alpha_y = given
    p_z = point.along - sign * point.back
    normal_x = alpha_x * (sign * point.x + p_z * cone.x)
    normal_y = alpha_y * (sign * point.y + p_z * cone.y)
    per_length2 = 1 / (normal_x * normal_x + normal_y * normal_y + p_z * p_z)
    twice = 2 * cone.eigenvalue * (point.along + sign * point.lean) * per_length2
    return twice * normal_x - x, twice * normal_y - y, cone.eigenvalue * remaining * per_length2


def point_across(cone: ReflectionCone, first: Array, second: Array) -> PointAcross:
    """Return a point of the cone, of which q is uniform for uniform numbers in [0, 1)².

    The cone is a disk: √(1 + αx²μ/λ)(p_x − w_x p_z) and √(1 + αy²μ/λ)(p_y − w_y p_z) are in the
    unit disk. Both numbers do not change along w.
    """
    angle = 2 * jnp.pi * second
    per_root = jax.lax.rsqrt(cone.eigenvalue)
    radius, per_eigenvalue = jnp.sqrt(first) * cone.eigenvalue * per_root, per_root * per_root
    d_x, d_y = radius * jnp.cos(angle) * cone.root_x, radius * jnp.sin(angle) * cone.root_y
    share_x, share_y = cone.drop_x * per_eigenvalue, cone.drop_y * per_eigenvalue
    w_x, w_y, per_length2 = cone.x, cone.y, cone.per_length * cone.per_length
    across_x, across_y = w_x * d_x, w_y * d_y
    sideways = across_x + across_y
    back = sideways * per_length2
    # q = (d_x, d_y, 0) − back·w, and along = √(1 − |q|²)/|w|. All terms of the root are positive.
    height2 = (1 - first) + share_x * d_x * d_x + share_y * d_y * d_y + back * sideways
    along = jnp.sqrt(height2) * cone.per_length
    tilt = (w_x * w_x + w_y * w_y) * per_length2
    lean = across_x * (share_x + tilt) + across_y * (share_y + tilt)
    return PointAcross(d_x, d_y, back, along, lean)


def _reflected(
    view: tuple[Array, Array, Array], normal_x: Array, normal_y: Array, normal_z: Array
) -> tuple[Array, Array, Array]:
    """Reflect a view about a normal of any length."""
    x, y, z = view
    length2 = normal_x * normal_x + normal_y * normal_y + normal_z * normal_z
    twice = 2 * (x * normal_x + y * normal_y + z * normal_z) / length2
    return twice * normal_x - x, twice * normal_y - y, twice * normal_z - z
