"""The form of Yeung's fit of the light on skin, of 2015: two curves that are blended by the radius.

The fit is in N = ½ + ½c and in (r − 2)/14, with the radius r from 2 to 16 mm. The two curves are
those at both ends. The first blends a polynomial in the shadow with a line in the light.
"""

import jax.numpy as jnp
from jax import Array

from fitting.form import Form, Stage
from integrals.reference import Reference, restricted
from quantities.skin.hyperbola_forms import MOST_CURVATURE
from shading.types import Scalar

LARGEST_RADIUS = 16.0
_LEAST_RADIUS = 1 / MOST_CURVATURE


def _unit(x) -> Array:
    return jnp.clip(x, 0.0, 1.0)


def _value(c, cosine: Scalar, curvature: Scalar) -> Array:
    n = 0.5 + 0.5 * jnp.asarray(cosine)
    t = _unit((n - c[0]) * c[1])
    shadow = t * t * (c[2] + t * c[3]) + c[4]
    share = _unit((n - c[7]) * c[8])
    share = share * share
    small = shadow * (1 - share) + _unit(c[5] * n + c[6]) * share
    wide = (1 / jnp.asarray(curvature) - _LEAST_RADIUS) / (LARGEST_RADIUS - _LEAST_RADIUS)
    left = (1 - wide) * (1 - wide)
    left = left * left
    return small * left + _unit(c[9] * n + c[10]) * (1 - left)


def yeung_form(reference: Reference) -> Form:
    """Return Yeung's form for a channel on a surface, for radii from 2 to 16 mm."""
    unit = "min(max({}, 0), 1)"
    return Form(
        name="yeung-skin",
        equation="; ".join(
            [
                "N = 0.5 + 0.5·c",
                f"t = {unit.format('(N − c0)·c1')}",
                "u = t²·(c2 + t·c3) + c4",
                f"v = {unit.format('c5·N + c6')}",
                f"s = {unit.format('(N − c7)·c8')}",
                f"w = {unit.format('c9·N + c10')}",
                "g = (1 − (1/κ − 2)/14)²",
                "D = (u·(1 − s²) + v·s²)·g² + w·(1 − g²)",
            ]
        ),
        reference=reference,
        axes=restricted(reference.axes, curvature=(1 / LARGEST_RADIUS, MOST_CURVATURE)),
        coefficient_names=[
            *("c0: t begins", "c1: t slope", "c2: t²", "c3: t³", "c4: 1"),
            *("c5: v slope", "c6: v", "c7: s begins", "c8: s slope", "c9: w slope", "c10: w"),
        ],
        stages=(Stage(_value),),
    )
