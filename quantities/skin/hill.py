"""The form of Hill's fit of the irradiance by a spherical Gaussian, which is a lobe on a sphere.

The sharpness λ of the spherical Gaussian is 1/s² of a lobe's width s. His irradiance is divided by
λ, here by the Gaussian's integral, so that a lobe is a mean.
"""

import jax.numpy as jnp
from jax import Array

from fitting.form import Form, Stage
from integrals.reference import Reference, restricted
from shading.types import Scalar

# Sharpness from 1 to 400. Below 1, which is not meant, the error rises to 0.5.
LEAST, MOST = 0.05, 1.0


def _value(c, cosine: Scalar, width: Scalar) -> Array:
    mu, s = jnp.asarray(cosine), jnp.asarray(width)
    inverse = s * s
    e = jnp.exp(-1 / inverse)
    e2 = e * e
    scale = 1 + 2 * e2 - inverse
    bias = (e - e2) * inverse - e2
    x = jnp.sqrt(1 - scale)
    x0, x1 = c[0] * mu, x / (4 * c[0])
    n = x0 + x1
    y = jnp.where(jnp.abs(x0) <= x1, n * n / x, jnp.clip(mu, 0.0, 1.0))
    return (scale * y + bias) / (1 - e2)


def hill_form(reference: Reference) -> Form:
    """Return Hill's form of a lobe on a sphere."""
    return Form(
        name="hill-skin",
        equation=(
            "e = exp(−1/s²); p = 1 + 2·e² − s²; b = (e − e²)·s² − e²; x = √(1 − p); "
            "x1 = x/(4·c0); z = max(c0·c, −x1); d = min(z − x1, 0); y = z/c0 + d²/x; "
            "D = (p·y + b)/(1 − e²)"
        ),
        reference=reference,
        axes=restricted(reference.axes, width=(LEAST, MOST)),
        coefficient_names=["c0"],
        stages=(Stage(_value),),
    )
