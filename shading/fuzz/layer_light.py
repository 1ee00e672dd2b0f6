"""What a layer of fibres sends to a view in ambient light: moments of where its light comes from.

The radiance of the layer is ∫ w(u) L(u) dω_u, where w ≥ 0 is the phase function times the kernel
of the layer. If L has no harmonics beyond order 2, only three moments of w matter: its integral M0,
the mean direction R = M1/M0 and the mean square M2/M0. An ambient model is a formula for them.

Every function takes scalars, which can be printed as shader code. docs/ambient-light.md has proofs.
"""

from typing import NamedTuple

import jax.numpy as jnp
from jax import Array

from shading.harmonics import FIRST, FLAT, SECOND, ZONAL, Coefficients
from shading.types import Scalar, Vector

# The constants of an ambient model
Constants = tuple[Scalar, ...]


class LayerView(NamedTuple):
    """A view of a layer: what the ambient models ask for, scalars.

    Attributes:
        cos_vn: v·n, the cosine of the view v and the normal n.
        cos_vt: v·t, the cosine of the view and the fibre t.
        cos_nt: n·t, the cosine of the normal and the fibre.
        alpha: α in (0, 1], the roughness.
        density: d ≥ 0, the thickness of the layer over its mean free path.
        scattering: G(d, v), exact or by a table.
        scattered: P_s(v), exact or by a table.
    """

    cos_vn: Scalar
    cos_vt: Scalar
    cos_nt: Scalar
    alpha: Scalar
    density: Scalar
    scattering: Scalar
    scattered: Scalar


class LayerLight(NamedTuple):
    """Moments of the light that a layer sends to a view, over the albedo of the fibres; scalars.

    The mean direction of the light is R = `along_normal` n + `along_view` v + `along_fiber` t. Its
    mean square M2/M0 is I/3 + the traceless part of the symmetric matrix

        `about_mean` R Rᵀ + `about_normal` n nᵀ + `about_view` v vᵀ + `about_fiber` t tᵀ
        + `normal_view` (n vᵀ + v nᵀ)/2 + `normal_fiber` (n tᵀ + t nᵀ)/2
        + `view_fiber` (v tᵀ + t vᵀ)/2.

    A term that a model does not have is the number 0.0, and costs nothing.

    Attributes:
        level: M0, the radiance of the layer in light of radiance one everywhere.
        along_normal, along_view, along_fiber: coefficients of R.
        about_mean, about_normal, about_view, about_fiber, normal_view, normal_fiber, view_fiber:
            coefficients of the mean square.
    """

    level: Scalar
    along_normal: Scalar = 0.0
    along_view: Scalar = 0.0
    along_fiber: Scalar = 0.0
    about_mean: Scalar = 0.0
    about_normal: Scalar = 0.0
    about_view: Scalar = 0.0
    about_fiber: Scalar = 0.0
    normal_view: Scalar = 0.0
    normal_fiber: Scalar = 0.0
    view_fiber: Scalar = 0.0


def mean_direction(light: LayerLight, normal: Vector, view: Vector, fiber: Vector) -> Array:
    """Return R (3,), the mean direction of the light. It is at most as long as a unit vector.

    `normal`, `view` and `fiber` are n, v and t, unit vectors in any frame, as for `light_weights`.
    """
    n, v, t = map(jnp.asarray, (normal, view, fiber))
    return n * light.along_normal + v * light.along_view + t * light.along_fiber


def length_squared(light: LayerLight, cos_vn: Scalar, cos_vt: Scalar, cos_nt: Scalar) -> Array:
    """Return |R|² from the coefficients of R and the cosines v·n, v·t and n·t."""
    n, v, t = map(jnp.asarray, (light.along_normal, light.along_view, light.along_fiber))
    crossed = n * v * cos_vn + t * (n * cos_nt + v * cos_vt)
    return n * n + v * v + t * t + 2 * crossed


def light_weights(light: LayerLight, normal: Vector, view: Vector, fiber: Vector) -> Array:
    """Return the weights (9,) of the nine harmonics of a light in the radiance of the layer.

    The radiance is their dot product with the coefficients of the light (`shading.harmonics`), for
    each colour. `normal`, `view` and `fiber` are n, v and t, unit vectors in the frame in which the
    light is given. The weights are M0 times the mean harmonics of the directions of the light.
    """
    mean = mean_direction(light, normal, view, fiber)
    first = (FIRST * light.level) * mean
    flat = jnp.asarray(FLAT * light.level)
    pairs = [
        (left, right)
        for left, terms in (
            (mean, ((light.about_mean, mean),)),
            (
                jnp.asarray(normal),
                (
                    (light.about_normal, normal),
                    (light.normal_view, view),
                    (light.normal_fiber, fiber),
                ),
            ),
            (jnp.asarray(view), ((light.about_view, view), (light.view_fiber, fiber))),
            (jnp.asarray(fiber), ((light.about_fiber, fiber),)),
        )
        if (right := _combined(terms)) is not None
    ]
    if not pairs:
        zero = jnp.zeros_like(flat)
        return jnp.stack([flat, first[1], first[2], first[0], *[zero] * 5])

    def entry(i: int, j: int) -> Array:
        """Return twice an element of the matrix off its diagonal, and once on it."""
        if i == j:
            parts = [left[i] * right[i] for left, right in pairs]
        else:
            parts = [left[i] * right[j] + left[j] * right[i] for left, right in pairs]
        return sum(parts[1:], parts[0])

    xx, yy, zz = entry(0, 0), entry(1, 1), entry(2, 2)
    half = (SECOND / 2) * light.level
    return jnp.stack(
        [
            flat,
            *(first[1], first[2], first[0]),
            *(half * entry(0, 1), half * entry(1, 2)),
            (ZONAL * light.level) * (2 * zz - xx - yy),
            *(half * entry(0, 2), half * (xx - yy)),
        ]
    )


def layer_radiance(
    light: LayerLight, coefficients: Coefficients, normal: Vector, view: Vector, fiber: Vector
) -> Array:
    """Return the radiance of the layer over the albedo of the fibres, a scalar or a colour (3,).

    `coefficients` (9,) or (9, 3) are those of the ambient light in the frame of n, v and t. The
    result is at least zero. Without this limit, light whose harmonics are negative in some
    directions could give a negative radiance.
    """
    weights = light_weights(light, normal, view, fiber)
    return jnp.maximum(weights @ jnp.asarray(coefficients), 0.0)


def _combined(terms: tuple[tuple[Scalar, Vector], ...]) -> Array | None:
    """Return the sum of the vectors times their coefficients; None if there are no terms."""
    used = [jnp.asarray(axis) * scale for scale, axis in terms if not _is_zero(scale)]
    return sum(used[1:], used[0]) if used else None


def _is_zero(value: Scalar) -> bool:
    """Return whether a coefficient is the default, a term that a model does not have."""
    return isinstance(value, float) and value == 0.0
