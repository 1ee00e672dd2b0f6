"""What a layer of fibres sends to a view in ambient light: moments of where its light comes from.

The radiance of the layer is ∫ w(u) L(u) dω_u, where w ≥ 0 is the phase function times the kernel
of the layer. If L has no harmonics beyond order 2, only three moments of w matter: its integral M0,
the mean direction R = M1/M0 and the mean square M2/M0. An ambient model is a formula for them.

Every function takes scalars, which can be printed as shader code. docs/ambient-light.md has proofs.
"""

from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from jax import Array

from shading.harmonics import Coefficients
from shading.types import Scalar, Vector


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

    The mean direction of the light is R = `along_normal` n + `along_view` v + `along_fiber` t. The
    mean square is M2/M0 = I/3 + the traceless part of

        `about_mean` R Rᵀ + `about_normal` n nᵀ + `about_view` v vᵀ + `about_fiber` t tᵀ.

    Attributes:
        level: M0, the radiance of the layer in light of radiance one everywhere.
        along_normal, along_view, along_fiber: coefficients of R.
        about_mean, about_normal, about_view, about_fiber: coefficients of the mean square.
    """

    level: Scalar
    along_normal: Scalar = 0.0
    along_view: Scalar = 0.0
    along_fiber: Scalar = 0.0
    about_mean: Scalar = 0.0
    about_normal: Scalar = 0.0
    about_view: Scalar = 0.0
    about_fiber: Scalar = 0.0


def mean_direction(light: LayerLight, normal: Vector, view: Vector, fiber: Vector) -> Array:
    """Return R (3,), the mean direction of the light. It is at most as long as a unit vector.

    `normal`, `view` and `fiber` are n, v and t, unit vectors in any frame, as for `light_weights`.
    """
    n, v, t = map(jnp.asarray, (normal, view, fiber))
    return n * light.along_normal + v * light.along_view + t * light.along_fiber


def light_weights(light: LayerLight, normal: Vector, view: Vector, fiber: Vector) -> Array:
    """Return the weights (9,) of the nine harmonics of a light in the radiance of the layer.

    The radiance is their dot product with the coefficients of the light (`shading.harmonics`), for
    each colour. `normal`, `view` and `fiber` are n, v and t, unit vectors in the frame in which the
    light is given. The weights are M0 times the mean harmonics of the directions of the light.
    """
    # notation: mean = R, (x, y) of a vector name its components.
    mean = mean_direction(light, normal, view, fiber)
    terms = (
        (light.about_mean, mean),
        (light.about_normal, jnp.asarray(normal)),
        (light.about_view, jnp.asarray(view)),
        (light.about_fiber, jnp.asarray(fiber)),
    )
    used = [(scale, each) for scale, each in terms if not _is_zero(scale)]
    first = (_FIRST * light.level) * mean
    flat = jnp.asarray(_FLAT * light.level)
    if not used:
        zero = jnp.zeros_like(flat)
        return jnp.stack([flat, first[1], first[2], first[0], *[zero] * 5])
    xx, yy, zz, xy, yz, xz = (
        sum(scale * each[i] * each[j] for scale, each in used)
        for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))
    )
    second = _SECOND * light.level
    return jnp.stack(
        [
            flat,
            *(first[1], first[2], first[0]),
            *(second * xy, second * yz),
            (_ZONAL * light.level) * (2 * zz - xx - yy),
            *(second * xz, (second / 2) * (xx - yy)),
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


# The constants of Y₀₀, of order 1, of order 2, and of Y₂₀, as in `shading.harmonics`.
_FLAT, _FIRST = float(np.sqrt(1 / (4 * np.pi))), float(np.sqrt(3 / (4 * np.pi)))
_SECOND, _ZONAL = float(np.sqrt(15 / (4 * np.pi))), float(np.sqrt(5 / (16 * np.pi)))


def _is_zero(value: Scalar) -> bool:
    """Return whether a coefficient is the default, a term that a model does not have."""
    return isinstance(value, float) and value == 0.0
