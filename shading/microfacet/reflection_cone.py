"""The cone of the microfacet normals of GGX that reflect a direction into the upper hemisphere.

The normals of GGX are those of an ellipsoid. M = diag(αx, αy, 1) maps unit vectors p to normals
m = Mp/|Mp|. For a given direction o, the reflection i of o about m has i·n = pᵀCp/|Mp|² with the
symmetric matrix

    C = ⎡ −αx²μ    0      αx·ox ⎤
        ⎢   0    −αy²μ    αy·oy ⎥        μ = o·n.
        ⎣ αx·ox  αy·oy      μ   ⎦

So i is above the horizon if and only if p is inside the cone pᵀCp > 0. For μ ≥ 0, C has one
positive eigenvalue λ. Its eigenvector w = (αx·ox/(λ + αx²μ), αy·oy/(λ + αy²μ), 1) is the axis of
the cone. docs/microfacet-sampling.md proves what is used here.
"""

import functools
from typing import NamedTuple

import jax
import jax.numpy as jnp
from jax import Array

from shading.microfacet.ggx import Roughness, widths
from shading.types import Vector

# After these steps the relative error of λ is 2e-7 and less than 1e-15 for α ≤ 1. For α up to 5 it
# is 6e-3 and less than 1e-14 (tests/shading/test_reflection_cone.py).
FLOAT32_STEPS, FLOAT64_STEPS = 1, 3
# Added to a divisor that is zero at normal incidence, where λ = μ whatever is divided. It is small
# enough to cost no step elsewhere, and large enough for half precision.
_SMALL = 1e-6


class ReflectionCone(NamedTuple):
    """The cone pᵀCp > 0: its positive eigenvalue λ, and its axis w = (`x`, `y`, 1).

    `drop_x` and `drop_y` are −C_xx = αx²μ and −C_yy = αy²μ. `per_length` is 1/|w|. `root_x` and
    `root_y` are 1/√(λ + αx²μ) and 1/√(λ + αy²μ).
    """

    eigenvalue: Array
    x: Array
    y: Array
    per_length: Array
    drop_x: Array
    drop_y: Array
    root_x: Array
    root_y: Array


def components(view: Vector, alpha: Roughness) -> tuple[Array, Array, Array, Array, Array]:
    """Return ox, oy, oz, αx and αy: what exported code takes in place of arrays."""
    return (*jnp.asarray(view), *widths(alpha))


def reflection_cone(view: Vector, alpha: Roughness, steps: int = FLOAT64_STEPS) -> ReflectionCone:
    """Return the cone of normals that reflect o = `view` into the upper hemisphere.

    `view` is a unit vector with o·n ≥ 0. `alpha` is α or (αx, αy), positive. `steps` is the number
    of iterations for λ: `FLOAT32_STEPS` or `FLOAT64_STEPS`.
    """
    return cone_of(*components(view, alpha), steps)


def cone_of(
    view_x: Array, view_y: Array, view_z: Array, alpha_x: Array, alpha_y: Array, steps: int
) -> ReflectionCone:
    """Return the cone as `reflection_cone` does, from the three components of the view."""
    stretched_x, stretched_y = alpha_x * view_x, alpha_y * view_y
    drop_x, drop_y = alpha_x * alpha_x * view_z, alpha_y * alpha_y * view_z
    eigenvalue = largest_eigenvalue(
        view_z, stretched_x * stretched_x, stretched_y * stretched_y, drop_x, drop_y, steps
    )
    root_x = jax.lax.rsqrt(eigenvalue + drop_x)
    root_y = jax.lax.rsqrt(eigenvalue + drop_y)
    axis_x, axis_y = stretched_x * root_x * root_x, stretched_y * root_y * root_y
    per_length = jax.lax.rsqrt(1 + axis_x * axis_x + axis_y * axis_y)
    return ReflectionCone(eigenvalue, axis_x, axis_y, per_length, drop_x, drop_y, root_x, root_y)


def upper_area(cone: ReflectionCone) -> Array:
    """Return N = λ²/(|w|² √((λ + αx²μ)(λ + αy²μ))), the area of the normals of upward reflections.

    It is the projected area, as seen from the view, of the microfacets that reflect the view into
    the upper hemisphere: ∫ D(m) (o·m) dω_m over these normals. D(h)/(4N) integrates to one over the
    directions of the upper hemisphere.
    """
    part = cone.eigenvalue * cone.per_length
    return part * part * cone.root_x * cone.root_y


@functools.partial(jax.custom_jvp, nondiff_argnums=(5,))
def largest_eigenvalue(
    height: Array, x2: Array, y2: Array, drop_x: Array, drop_y: Array, steps: int
) -> Array:
    """Return the root λ > 0 of λ = μ + X/(λ + a) + Y/(λ + b).

    μ = `height`, X = `x2`, Y = `y2`, a = `drop_x` and b = `drop_y` are not negative. The start is
    the root for a = b = (aX + bY)/(X + Y). The steps are Laguerre's for the cubic
    f = (λ − μ)(λ + a)(λ + b) − X(λ + b) − Y(λ + a). All three roots of f are real, so his method
    converges, and its radicand is not negative. The derivative is that of the implicit equation.
    """
    total = x2 + y2
    mean = (x2 * drop_x + y2 * drop_y) / (total + _SMALL)
    half = (height - mean) / 2
    root = half + jnp.sqrt(half * half + (height * mean + total))
    for _ in range(steps):
        over_x, over_y, above = root + drop_x, root + drop_y, root - height
        product, both = over_x * over_y, over_x + over_y
        value = above * product - x2 * over_y - y2 * over_x
        slope = product + above * both - total
        radicand = jnp.maximum(slope * slope - 3 * value * (both + above), 0.0)
        root = root - 3 * value / (slope + 2 * jnp.sqrt(radicand))
    return root


@largest_eigenvalue.defjvp
def _implicit(steps, primals, tangents):
    height, x2, y2, drop_x, drop_y = primals
    d_height, d_x2, d_y2, d_drop_x, d_drop_y = tangents
    root = largest_eigenvalue(height, x2, y2, drop_x, drop_y, steps)
    per_x, per_y = 1 / (root + drop_x), 1 / (root + drop_y)
    pull_x, pull_y = x2 * per_x * per_x, y2 * per_y * per_y
    change = d_height + d_x2 * per_x + d_y2 * per_y - pull_x * d_drop_x - pull_y * d_drop_y
    return root, change / (1 + pull_x + pull_y)
