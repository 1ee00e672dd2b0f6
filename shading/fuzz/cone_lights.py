"""Ambient models of the layer that use the cone of lit normals and its closed moments.

Each function returns the moments of the light from a view and the model's constants. P_s comes from
the cone. G is given. All arguments are limited to their domains first.

Notation: a = v·t, b = n·t, c = v·n, κ = 1 − α², σ² = 1 − κa², and u = 1 − P_s. r, μ̄ and T_w are the
`direction`, the `cosine` and the `mean_square` of `LitMoments`.
"""

from typing import NamedTuple

import jax.numpy as jnp
from jax import Array

from shading.fuzz.ambient import lit_by_constants
from shading.fuzz.layer_light import Constants, LayerLight, LayerView, length_squared
from shading.fuzz.lit_cone import FEWEST_STEPS
from shading.fuzz.lit_moments import LitMoments, lit_moments
from shading.types import Scalar

# The least α, v·n and d. At v·n = 0 the kernel of the layer has no limit for d → 0.
LEAST_ALPHA, LEAST_COSINE, LEAST_DENSITY = 0.05, 1e-3, 1e-3


class _Place(NamedTuple):
    """The arguments of a model within their domains, and what follows from them.

    `sharp` is ακ and `area` is σ.
    """

    a: Array
    b: Array
    c: Array
    alpha: Array
    density: Array
    scattering: Scalar
    kappa: Array
    sharp: Array
    area: Array
    moments: LitMoments


def mean_cosine_light(view: LayerView, k: Constants) -> LayerLight:
    """Return M0 with the kernel of the layer at the mean cosine of the light, and R = n/2.

    M0 = Ẽ G g(2θμ̄)/g(θ), where g is the kernel, θ = k₂ is a node, and Ẽ is E_lit with the
    constants k₀ and k₁. It is exact at α = 1 for all k.
    """
    return LayerLight(jnp.minimum(_level(_placed(view), k), 1.0), 0.5)


def mean_direction_light(view: LayerView, k: Constants) -> LayerLight:
    """Return the M0 of `mean_cosine_light`, and R from the closed mean direction r.

    R = (k₃ + k₄ακσ) r + k₅ακσ n + k₆ακb t. The light has the same variance along all lines about R.
    """
    place = _placed(view)
    scale, normal = _lean(place, k[3:6])
    fiber = place.sharp * place.b * k[6]
    light = _light(_level(place, k), place.moments.direction * scale, normal, fiber)
    return light._replace(about_mean=1.0)


def recommended_light(view: LayerView, k: Constants) -> LayerLight:
    """Return M0, R and the mean square of the light about R.

    M0 = Ẽ G g(2θμ̄)/g(θ) (1 + k₃κμ̄),
    R = (k₄ + k₅ακσ) r + k₆ακσ n + b (ακ(k₇ + k₈T_w) + k₉κμ̄b²) t, and the mean square is
    R Rᵀ + (1 − |R|²) (k₁₀ n nᵀ + κ²u (k₁₁ t tᵀ + k₁₂b v tᵀ) + k₁₃κ²b² R vᵀ).
    """
    place = _placed(view)
    b, kappa, sharp, moments = place.b, place.kappa, place.sharp, place.moments
    level = _level(place, k) * (1 + k[3] * (kappa * moments.cosine))
    scale, normal = _lean(place, k[4:7])
    fiber = sharp * (k[7] + k[8] * moments.mean_square) + k[9] * (kappa * moments.cosine) * (b * b)
    light = _light(level, moments.direction * scale, normal, b * fiber)
    square = kappa * kappa
    lit = square * moments.fraction
    mixed = k[13] * (square * (b * b))
    return _spread(
        light,
        place,
        about_normal=k[10],
        about_fiber=k[11] * lit,
        about_view=mixed * light.along_view,
        normal_view=mixed * light.along_normal,
        view_fiber=k[12] * (lit * b) + mixed * light.along_fiber,
    )


def best_light(view: LayerView, k: Constants) -> LayerLight:
    """Return M0, R and the mean square of the light with more terms than `recommended_light`.

    With s = d/(d + c), M0 = Ẽ G g(2θμ̄)/g(θ) (1 + κ(k₃μ̄ + α(k₄u + k₅s))), R is the sum of

        (k₆ + k₇T_w + k₈ακσ) r,    (k₉ακσ + k₁₀c + k₁₁s) n,
        b (ακ(k₁₂ + k₁₃T_w) + κ(k₁₄μ̄b² + k₁₅σ)) t,    aκ (k₁₆αa² + k₁₇κ) t,

    and the mean square is R Rᵀ + (1 − |R|²) times

        k₁₈ακb² R Rᵀ + k₁₉ n nᵀ + κ²u (k₂₀ t tᵀ + k₂₁b v tᵀ) + k₂₂κub n tᵀ + k₂₃κ²T_w a v tᵀ.
    """
    place = _placed(view)
    a, b, alpha, kappa, moments = place.a, place.b, place.alpha, place.kappa, place.moments
    up, cosine, mean_square = moments.fraction, moments.cosine, moments.mean_square
    share = place.density / (place.density + place.c)
    level = _level(place, k) * (1 + kappa * (k[3] * cosine + alpha * (k[4] * up + k[5] * share)))
    scale, normal = _lean(place, (k[6] + k[7] * mean_square, k[8], k[9]))
    normal = normal + k[10] * place.c + k[11] * share
    # `upright` and `along` are the parts of R along t that follow b and a.
    b2 = b * b
    bent = alpha * (k[12] + k[13] * mean_square) + (k[14] * (cosine * b2) + k[15] * place.area)
    upright, along = b * bent, a * (k[16] * (alpha * (a * a)) + k[17] * kappa)
    light = _light(level, moments.direction * scale, normal, kappa * (upright + along))
    square, mixed = kappa * kappa, kappa * (up * b)
    return _spread(
        light,
        place,
        about_mean=k[18] * (place.sharp * b2),
        about_normal=k[19],
        about_fiber=k[20] * (square * up),
        view_fiber=kappa * (k[21] * mixed + k[23] * (kappa * (mean_square * a))),
        normal_fiber=k[22] * mixed,
    )


def _placed(view: LayerView) -> _Place:
    c, a, b = (
        jnp.clip(cosine, least, 1.0)
        for cosine, least in (
            (view.cos_vn, LEAST_COSINE),
            (view.cos_vt, -1.0),
            (view.cos_nt, -1.0),
        )
    )
    alpha = jnp.clip(view.alpha, LEAST_ALPHA, 1.0)
    density = jnp.maximum(view.density, LEAST_DENSITY)
    kappa = (1 - alpha) * (1 + alpha)
    area = jnp.sqrt(1 - kappa * (a * a))
    moments = lit_moments(c, a, b, alpha, FEWEST_STEPS)
    # Only rounding, and cosines that belong to no unit vectors, lead to more than one.
    moments = moments._replace(
        fraction=jnp.minimum(moments.fraction, 1.0), cosine=jnp.minimum(moments.cosine, 1.0)
    )
    return _Place(a, b, c, alpha, density, view.scattering, kappa, alpha * kappa, area, moments)


def _level(place: _Place, k: Constants) -> Array:
    """Return M0 = Ẽ G g(2θμ̄)/g(θ) with E_lit's constants k₀ and k₁ and the node θ = k₂."""
    lit = lit_by_constants(k[:2], place.moments.fraction, place.a, place.alpha)
    here = _kernel(2 * k[2] * place.moments.cosine, place)
    return lit * (place.scattering * (here / _kernel(k[2], place)))


def _kernel(cosine: Scalar, place: _Place) -> Array:
    """Return the kernel of the layer, `scattering_kernel`, for a light with this cosine."""
    path = place.density / cosine + place.density / place.c
    return cosine * (1 - jnp.exp(-path)) / (cosine + place.c)


def _lean(place: _Place, k: Constants) -> tuple[Array, Array]:
    """Return k₀ + k₁ακσ and k₂ακσ, the factor of r and the part of R along n."""
    lean = place.sharp * place.area
    return jnp.asarray(k[0] + lean * k[1]), lean * k[2]


def _light(level: Array, mean: Array, normal: Array, fiber: Array) -> LayerLight:
    """Return the light with M0 ≤ 1 and R = `mean` + `normal` n + `fiber` t."""
    return LayerLight(jnp.minimum(level, 1.0), mean[0] + normal, mean[1], mean[2] + fiber)


def _spread(
    light: LayerLight, place: _Place, about_mean: Scalar = 0.0, **coefficients: Scalar
) -> LayerLight:
    """Return the light with the mean square R Rᵀ + (1 − |R|²) times a matrix."""
    room = jnp.maximum(1 - length_squared(light, place.c, place.a, place.b), 0.0)
    scaled = {name: room * each for name, each in coefficients.items()}
    return light._replace(about_mean=1 + room * about_mean, **scaled)
