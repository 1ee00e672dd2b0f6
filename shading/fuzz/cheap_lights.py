"""Ambient models of the layer without the cone of lit normals: from P_s, G and a few products.

Each function returns the moments of the light from a view and the model's constants. P_s and G are
given, so they may come from tables.
"""

import jax.numpy as jnp
from jax import Array

from shading.fuzz.ambient import corrected_layer
from shading.fuzz.layer_light import Constants, LayerLight, LayerView


def talk_light(view: LayerView, _: Constants = ()) -> LayerLight:
    """Return G (1 − P_s) for M0 and n/2 for R: the mean radiance over the hemisphere."""
    return LayerLight(view.scattering * (1 - jnp.asarray(view.scattered)), 0.5)


def cheap_light(view: LayerView, k: Constants) -> LayerLight:
    """Return the moments that belong to `ambient_layer_lit`: M0 corrected, and R = n/2.

    k₀ and k₁ are the constants of E_lit, k₂ and k₃ the level and slope of the correlation.
    """
    return LayerLight(_corrected(view, k), 0.5)


def cheap_directed_light(view: LayerView, k: Constants) -> LayerLight:
    """Return the M0 of `cheap_light`, with R and the mean square from products of cosines.

    With κ = 1 − α², a = v·t, b = n·t and u = 1 − P_s,
    R = (k₄ + k₅κab) n + κ² ((k₆b² + k₉σσ_n) v − (k₇a + k₈bu) t). The light has the same variance
    along all lines about R.
    """
    a, b, alpha = map(jnp.asarray, (view.cos_vt, view.cos_nt, view.alpha))
    up, kappa = 1 - jnp.asarray(view.scattered), (1 - alpha) * (1 + alpha)
    areas = jnp.sqrt((1 - kappa * a * a) * (1 - kappa * b * b))
    square = kappa * kappa
    return LayerLight(
        _corrected(view, k[:4]),
        along_normal=k[4] + k[5] * (kappa * (a * b)),
        along_view=square * (k[6] * (b * b) + k[9] * areas),
        along_fiber=-square * (k[7] * a + k[8] * (b * up)),
        about_mean=1.0,
    )


def _corrected(view: LayerView, k: Constants) -> Array:
    return corrected_layer(view.scattering, view.scattered, view.cos_vt, view.cos_nt, view.alpha, k)
