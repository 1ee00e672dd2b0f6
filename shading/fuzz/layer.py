"""The thin scattering layer of Koenderink and Pont (2003), as section 1 of the supplement uses it.

The density d ≥ 0 is the thickness of the layer divided by its mean free path, so it has no unit.
All cosines are between a direction and the surface normal n.
"""

import jax
import jax.numpy as jnp
from jax import Array

from shading.types import Scalar

# exp(−path) is zero in float64 and in float32 for any longer optical path.
_OPAQUE = 800.0


@jax.custom_jvp
def optical_path(density: Scalar, cosine: Scalar) -> Array:
    """Return the optical path d/(ω·n) through the layer, but at most 800.

    `cosine` is ω·n in (0, 1]. The limit prevents overflow at grazing directions. The derivative
    prevents it too: it is written without (ω·n)².
    """
    return jnp.minimum(jnp.asarray(density) / jnp.asarray(cosine), _OPAQUE)


@optical_path.defjvp
def _path_derivative(primals, tangents):
    path = optical_path(*primals)
    return path, (tangents[0] - path * tangents[1]) / primals[1]


def penetration(cos_u: Scalar, density: Scalar) -> Array:
    """Return P_p = exp(−d/(u·n)), the probability that a ray crosses the layer unscattered.

    `cos_u` is u·n in (0, 1].
    """
    return jnp.exp(-optical_path(density, cos_u))


def scattering_kernel(cos_u: Scalar, cos_v: Scalar, density: Scalar) -> Array:
    """Return g(u, v), the BRDF of the layer times u·n, without albedo and phase function (Eq. 3).

    g = (u·n) (1 − exp(−d (u+v)·n / ((u·n)(v·n)))) / ((u+v)·n), where `cos_u` = u·n and
    `cos_v` = v·n are in (0, 1].

    The supplement prints (u·v)(v·n) in the exponent, but then the integral of g over the
    hemisphere diverges. Koenderink and Pont have (u·n)(v·n), which is used here.
    """
    cos_u, cos_v = jnp.asarray(cos_u), jnp.asarray(cos_v)
    # The fraction in the exponent is split into two, because the product (u·n)(v·n) may underflow.
    path = optical_path(density, cos_u) + optical_path(density, cos_v)
    return cos_u * -jnp.expm1(-path) / (cos_u + cos_v)
