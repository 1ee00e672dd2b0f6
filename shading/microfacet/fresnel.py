"""Fresnel's reflectance of unpolarised light: Schlick's approximation, dielectrics, and conductors.

`cosine` is x = o·m in [0, 1], the cosine of the angle between the light and the facet.
"""

import jax.numpy as jnp
from jax import Array

from shading.types import Scalar

# Added under roots that may be zero. It keeps derivatives finite, and changes a reflectance by less
# than a rounding.
_TINY = 1e-300


def schlick(cosine: Scalar, normal_reflectance: Scalar) -> Array:
    """Return F0 + (1 − F0)(1 − x)⁵, with the reflectance F0 at normal incidence (Schlick 1994)."""
    f0 = jnp.asarray(normal_reflectance)
    return f0 + (1 - f0) * (1 - jnp.asarray(cosine)) ** 5


def dielectric(cosine: Scalar, index: Scalar) -> Array:
    """Return the reflectance of a dielectric with the relative index of refraction η > 0.

    η is the index inside over that outside. For η < 1 light is reflected completely where
    x² ≤ 1 − η². There the slope is zero, and at x² = 1 − η² itself there is none.
    """
    x, eta = jnp.asarray(cosine), jnp.asarray(index)
    inside = (eta - 1) * (eta + 1) + x * x  # η² cos² of the refracted light
    refracted = inside > 0
    g = jnp.sqrt(jnp.where(refracted, inside, 1.0))
    eta2 = eta * eta
    across = (x - g) / (x + g)
    along = (eta2 * x - g) / (eta2 * x + g)
    return jnp.where(refracted, (across * across + along * along) / 2, 1.0)


def conductor(cosine: Scalar, index: Scalar, extinction: Scalar) -> Array:
    """Return the reflectance of a conductor with the relative index η + ik, η > 0, k ≥ 0."""
    # notation: (a + ib)² = (η + ik)² − sin²; both polarisations by a and a² + b².
    x, eta, k = jnp.asarray(cosine), jnp.asarray(index), jnp.asarray(extinction)
    x2 = x * x
    sine2 = (1 - x) * (1 + x)
    real = (eta - k) * (eta + k) - sine2
    length = jnp.sqrt(real * real + 4 * eta * eta * k * k + _TINY)
    # a² = (length + real)/2: where real < 0, the other factor of 4η²k² does not cancel.
    a2 = jnp.where(
        real < 0,
        2 * eta * eta * k * k / jnp.where(real < 0, length - real, 1.0),
        (length + real) / 2,
    )
    a = jnp.sqrt(a2 + _TINY)
    across = (length + x2 - 2 * a * x) / (length + x2 + 2 * a * x)
    squared = length * x2 + sine2 * sine2
    along = (squared - 2 * a * x * sine2) / (squared + 2 * a * x * sine2)
    return across * (1 + along) / 2
