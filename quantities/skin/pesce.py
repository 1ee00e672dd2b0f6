"""The form of Pesce's fit of the light on skin, of 2012: a cube that is blended with the cosine."""

import jax.numpy as jnp
from jax import Array

from fitting.form import Form, Stage
from integrals.reference import Reference, restricted
from quantities.skin.hyperbola_forms import MOST_CURVATURE
from shading.types import Scalar

# The fit is in the radius in mm; it was made for 0.25 to 16.
_LARGEST_RADIUS = 16.0


def _value(c, cosine: Scalar, curvature: Scalar) -> Array:
    x, r = jnp.asarray(cosine), 1 / jnp.asarray(curvature)
    t = x * (c[0] * r + c[1]) + c[2] * r + c[3]
    blend = jnp.clip(c[4] * r + c[5], 0.0, 1.0)
    return t * t * t * blend + jnp.clip(x, 0.0, 1.0) * (1 - blend)


def pesce_form(reference: Reference) -> Form:
    """Return Pesce's form for a channel on a surface, for radii from 2 to 16 mm."""
    return Form(
        name="pesce-skin",
        equation=(
            "r = 1/κ; t = c·(c0·r + c1) + c2·r + c3; f = min(max(c4·r + c5, 0), 1); "
            "D = t³·f + min(max(c, 0), 1)·(1 − f)"
        ),
        reference=reference,
        axes=restricted(reference.axes, curvature=(1 / _LARGEST_RADIUS, MOST_CURVATURE)),
        coefficient_names=["c0: c·r", "c1: c", "c2: r", "c3: 1", "c4: blend r", "c5: blend 1"],
        stages=(Stage(_value),),
    )
