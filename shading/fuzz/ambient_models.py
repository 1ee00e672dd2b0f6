"""Ambient models of the layer of fibres, from the talk's to the most precise, by name.

Each model is a formula for the moments of the light that the layer sends to a view (`LayerLight`),
which `layer_radiance` multiplies by the nine harmonics of a light. A model's constants are fitted
to exact moments at many materials and views. docs/ambient-light.md derives the formulas and states
the errors. All models are the same for t and −t.
"""

from collections.abc import Callable
from dataclasses import dataclass

import jax.numpy as jnp
from jax import Array

from shading.fuzz.ambient import LIT_LAYER_CONSTANTS, corrected_layer, lit_by_constants
from shading.fuzz.layer_light import LayerLight, LayerView
from shading.fuzz.lit_moments import LitMoments, lit_moments
from shading.types import Scalar

Constants = tuple[float, ...]

# What models with the lit cone limit their arguments to. At v·n = 0 the kernel of the layer has no
# limit for d → 0.
LEAST_ALPHA, LEAST_COSINE, LEAST_DENSITY = 0.05, 1e-3, 1e-3
# One Newton step for λ: P_s has an error of at most 3e-4 (docs/closed-form.md).
_STEPS = 1


@dataclass(frozen=True)
class AmbientModel:
    """A model of the layer in ambient light.

    Attributes:
        name: the name in tables and on the command line.
        meaning: one line that says what the model takes into account.
        light: the moments from a view and the constants, a pure JAX function of scalars.
        constants: the fitted constants, in the order that `light` takes them.
        arguments: the fields of `LayerView` that `light` reads.
    """

    name: str
    meaning: str
    light: Callable[[LayerView, Constants], LayerLight]
    constants: Constants
    arguments: tuple[str, ...]

    def __call__(self, view: LayerView) -> LayerLight:
        """Return the moments of the light towards a view, with the model's constants."""
        return self.light(view, self.constants)


def talk_light(view: LayerView, _: Constants = ()) -> LayerLight:
    """Return G (1 − P_s) for M0 and n/2 for R: the mean radiance over the hemisphere."""
    return LayerLight(view.scattering * (1 - jnp.asarray(view.scattered)), 0.5)


def cheap_light(view: LayerView, constants: Constants) -> LayerLight:
    """Return the moments that belong to `ambient_layer_lit`: M0 corrected, and R = n/2.

    `constants` are k₀ and k₁ of `lit_fraction`, and the level and slope of the correlation.
    """
    return LayerLight(_corrected(view, constants), 0.5)


def cheap_directed_light(view: LayerView, constants: Constants) -> LayerLight:
    """Return the M0 of `cheap_light`, with R and the mean square without the lit cone.

    With κ, a = v·t, b = n·t, u = 1 − P_s and k the constants after the four of `cheap_light`,
    R = (k₄ + k₅κab) n + κ² (k₆b² v − (k₇a + k₈bu) t) + k₉κ²σσ_n v, and the mean square is
    k₁₀|R|² R Rᵀ.
    """
    a, b, alpha = map(jnp.asarray, (view.cos_vt, view.cos_nt, view.alpha))
    up, kappa = 1 - jnp.asarray(view.scattered), (1 - alpha) * (1 + alpha)
    k = constants[4:]
    areas = jnp.sqrt((1 - kappa * a * a) * (1 - kappa * b * b))
    square = kappa * kappa
    light = LayerLight(
        _corrected(view, constants[:4]),
        along_normal=k[0] + k[1] * kappa * a * b,
        along_view=square * (k[2] * b * b + k[5] * areas),
        along_fiber=-square * (k[3] * a + k[4] * b * up),
    )
    return light._replace(about_mean=k[6] * mean_square_length(light, view))


def mean_cosine_light(view: LayerView, constants: Constants) -> LayerLight:
    """Return M0 with the kernel at the mean cosine of the light, and R = n/2.

    `constants` are k₀ and k₁ of `lit_fraction`, and the node θ of `_level`.
    """
    moments = _moments(view)
    return LayerLight(_level(view, moments, constants[:2], constants[2]), 0.5)


def first_order_light(view: LayerView, constants: Constants) -> LayerLight:
    """Return the M0 of `mean_cosine_light`, and R from the closed mean direction r.

    R = (k₃ + k₄ακb²) r + k₅ n + ακ (k₆b + k₇a) t.
    """
    moments = _moments(view)
    level = _level(view, moments, constants[:2], constants[2])
    return _directed(level, view, moments.direction, constants[3:8])


def recommended_light(view: LayerView, constants: Constants) -> LayerLight:
    """Return M0 and R as `first_order_light`, and the mean square k₈|R|² R Rᵀ + k₉κb² t tᵀ."""
    light = first_order_light(view, constants[:8])
    b, alpha = _clamped(view.cos_nt, -1.0, 1.0), _clamped(view.alpha, LEAST_ALPHA, 1.0)
    kappa = (1 - alpha) * (1 + alpha)
    return light._replace(
        about_mean=constants[8] * mean_square_length(light, view),
        about_fiber=constants[9] * kappa * b * b,
    )


def mean_square_length(light: LayerLight, view: LayerView) -> Array:
    """Return |R|² from the coefficients of R and the cosines between n, v and t."""
    n, v, t = map(jnp.asarray, (light.along_normal, light.along_view, light.along_fiber))
    crossed = n * v * view.cos_vn + t * (n * view.cos_nt + v * view.cos_vt)
    return n * n + v * v + t * t + 2 * crossed


def _corrected(view: LayerView, constants: Constants) -> Array:
    return corrected_layer(
        view.scattering, view.scattered, view.cos_vt, view.cos_nt, view.alpha, constants
    )


def _moments(view: LayerView) -> LitMoments:
    """Return the moments of the lit normals, for arguments of any size."""
    return lit_moments(
        _clamped(view.cos_vn, LEAST_COSINE, 1.0),
        _clamped(view.cos_vt, -1.0, 1.0),
        _clamped(view.cos_nt, -1.0, 1.0),
        _clamped(view.alpha, LEAST_ALPHA, 1.0),
        _STEPS,
    )


def _level(view: LayerView, moments: LitMoments, lit: Constants, node: float) -> Array:
    """Return M0 = E_lit G g(2θμ̄)/g(θ), where g is the kernel of the layer and θ the node.

    It is exact at α = 1 and for d → 0.
    """
    cos_vt, alpha = _clamped(view.cos_vt, -1.0, 1.0), _clamped(view.alpha, LEAST_ALPHA, 1.0)
    fraction = lit_by_constants(lit, moments.fraction, cos_vt, alpha)
    cosine = _clamped(view.cos_vn, LEAST_COSINE, 1.0)
    density = jnp.maximum(view.density, LEAST_DENSITY)
    ratio = _kernel(2 * node * moments.cosine, cosine, density) / _kernel(node, cosine, density)
    return jnp.minimum(fraction * view.scattering * ratio, 1.0)


def _kernel(cos_u: Scalar, cos_v: Array, density: Array) -> Array:
    path = density / cos_u + density / cos_v
    return cos_u * (1 - jnp.exp(-path)) / (cos_u + cos_v)


def _directed(level: Array, view: LayerView, mean: Array, k: Constants) -> LayerLight:
    a, b = _clamped(view.cos_vt, -1.0, 1.0), _clamped(view.cos_nt, -1.0, 1.0)
    alpha = _clamped(view.alpha, LEAST_ALPHA, 1.0)
    sharp = alpha * ((1 - alpha) * (1 + alpha))
    scale = k[0] + k[1] * sharp * b * b
    return LayerLight(
        level,
        along_normal=scale * mean[0] + k[2],
        along_view=scale * mean[1],
        along_fiber=scale * mean[2] + sharp * (k[3] * b + k[4] * a),
    )


def _clamped(value: Scalar, least: float, most: float) -> Array:
    return jnp.minimum(jnp.maximum(value, least), most)


_TABLES = ("scattering", "scattered")
_MATERIAL = ("cos_vt", "cos_nt", "alpha")
_CONE = ("cos_vn", "cos_vt", "cos_nt", "alpha", "density", "scattering")

AMBIENT_MODELS = {
    model.name: model
    for model in (
        AmbientModel("talk", "products of averages, as the talk has them", talk_light, (), _TABLES),
        AmbientModel(
            "cheap",
            "E_lit and its correlation with the kernel",
            cheap_light,
            LIT_LAYER_CONSTANTS,
            (*_MATERIAL, *_TABLES),
        ),
        AmbientModel(
            "cheap-directed",
            "as cheap, with a mean direction that needs no root",
            cheap_directed_light,
            (
                *(1.2796, 0.9097, 0.8498, 0.3183),
                *(0.5641, 0.5196, 0.2600, 1.2095, 0.4284, 0.2367, 1.0098),
            ),
            ("cos_vn", *_MATERIAL, *_TABLES),
        ),
        AmbientModel(
            "mean-cosine",
            "E_lit, and the kernel at the mean cosine of the light",
            mean_cosine_light,
            (1.3634, 0.9563, 0.58),
            _CONE,
        ),
        AmbientModel(
            "first-order",
            "as mean-cosine, with the mean direction of the light",
            first_order_light,
            (1.3202, 0.8705, 0.5998, 0.9682, -0.5055, 0.0727, 0.2497 + 0.125, 0.2497),
            _CONE,
        ),
        AmbientModel(
            "recommended",
            "as first-order, with the spread of the light about its mean direction",
            recommended_light,
            (
                *(1.3202, 0.8705, 0.5998),
                *(0.9682, -0.5055, 0.0727, 0.3747, 0.2497, 1.3783, -0.1568),
            ),
            _CONE,
        ),
    )
}
