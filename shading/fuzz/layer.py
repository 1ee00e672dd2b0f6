"""The thin scattering layer of Koenderink and Pont (2003), as the supplement's section 1 uses it.

Densities d ≥ 0 are the layer's thickness over its mean free path; cosines are with the normal.
"""

import jax
import jax.numpy as jnp
from jax import Array

from shading.types import Scalar

# Beyond this optical path exp(−path) is zero in float64 and float32.
_OPAQUE = 800.0


@jax.custom_jvp
def optical_path(density: Scalar, cosine: Scalar) -> Array:
    """Give the optical path d/(ω·n) through the layer, or 800 where it is longer.

    `cosine` is ω·n in (0, 1]. The cap and the derivative, written without (ω·n)², keep grazing
    directions from overflowing.
    """
    return jnp.minimum(jnp.asarray(density) / jnp.asarray(cosine), _OPAQUE)


@optical_path.defjvp
def _path_derivative(primals, tangents):
    path = optical_path(*primals)
    return path, (tangents[0] - path * tangents[1]) / primals[1]


def penetration(cos_u: Scalar, density: Scalar) -> Array:
    """Give P_p = exp(−d/(u·n)), the chance that a ray crosses the layer without being scattered.

    `cos_u` is u·n in (0, 1].
    """
    return jnp.exp(-optical_path(density, cos_u))


def scattering_kernel(cos_u: Scalar, cos_v: Scalar, density: Scalar) -> Array:
    """Give g(u, v), the layer's reflected radiance without albedo and phase function (Eq. 3).

    g = (u·n) (1 − exp(−d (u+v)·n / ((u·n)(v·n)))) / ((u+v)·n), with `cos_u` = u·n and
    `cos_v` = v·n in (0, 1]. The product in the exponent is (u·n)(v·n), as in Koenderink and
    Pont; with the printed (u·v)(v·n) the integral of g over the hemisphere diverges.
    """
    cos_u, cos_v = jnp.asarray(cos_u), jnp.asarray(cos_v)
    # The quotient is split so that no product of two small cosines underflows.
    path = optical_path(density, cos_u) + optical_path(density, cos_v)
    return cos_u * -jnp.expm1(-path) / (cos_u + cos_v)
