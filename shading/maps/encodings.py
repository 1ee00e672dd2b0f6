"""Decoding of anisotropic roughness from three channels of a texture: formulas of one texel.

The roughness in the frame of the normal is the matrix S = αt² t tᵀ + αb² b bᵀ with the entries Sxx,
Sxy and Syy. t = (cos θ, sin θ) is the tangent of the larger width αt ≥ αb, and b is across it. An
encoding stores S in three channels (x, y, z) in [0, 1]:

* `published`: (√Sxx, ½ + ½ρ, √Syy) with ρ = Sxy/√(SxxSyy), as in *Samurai Shading in Ghost of
  Tsushima*;
* `stereographic`: (√Sxx, ½ + ½u, √Syy) with ρ = 2u/(1 + u²), so that √(1 − ρ²) is rational too;
* `quarter-root`: the matrix Q with Q⁴ = S, as (m, d cos 2θ, d sin 2θ) with m ± d = √α;
* `logarithmic`: the logarithm of S alike, with m ± d = 1 − ln α / ln 0.02.

The last two store zero as 128/255, which is a code of 8 and of 16 bits. All decoders clamp their
channels, so that any texel, filtered or damaged by compression, gives a positive definite matrix.
They use no `sign`, no division by zero and no root of zero: derivatives are finite at isotropy too,
where the tangent is (1, 0).
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import log, sqrt

import jax.numpy as jnp
from jax import Array

from shading.types import Scalar

# The least width that decoders return. The least ratio αb/αt that correlations are clamped to.
LEAST_ALPHA = 0.01
# The least width that the logarithmic encoding stores.
LEAST_LOGARITHMIC = 0.02
# A channel stores the number d in [-½, ½] as CENTRE + SPREAD d.
CENTRE, SPREAD = 128 / 255, 254 / 255
# Below this square of a difference of widths, the roughness counts as isotropic.
NO_DIFFERENCE = 1e-10
# The same in half precision: a difference of about one rounding of numbers near ½
NO_DIFFERENCE_HALF = 1e-7

_LARGEST_U = (1 - LEAST_ALPHA) / (1 + LEAST_ALPHA)
_LARGEST_RHO = (1 - LEAST_ALPHA**2) / (1 + LEAST_ALPHA**2)
_LEAST_ROOT = sqrt(LEAST_ALPHA)
# Vectors of the quarter root that are too long are divided by no less than the root of this.
_SHORT2 = 1e-4

# (αt, αb, cos θ, sin θ), and (Sxx, Sxy, Syy, αtαb)
Widths = tuple[Array, Array, Array, Array]
Entries = tuple[Array, Array, Array, Array]


@dataclass(frozen=True)
class Decoding:
    """The two decoders of an encoding; both take three channels, and what counts as isotropic.

    `widths` returns (αt, αb, cos θ, sin θ) with cos θ ≥ 0. `entries` returns (Sxx, Sxy, Syy, P)
    with P = αtαb = √(SxxSyy − Sxy²).
    """

    name: str
    widths: Callable[..., Widths]
    entries: Callable[..., Entries]


def decode_widths(
    encoding: str, x: Scalar, y: Scalar, z: Scalar, isotropic: float = NO_DIFFERENCE
) -> Widths:
    """Return (αt, αb, cos θ, sin θ) of a texel: the widths and the tangent of the larger one.

    The channels are clamped to [0, 1], and the widths to [0.01, 1]. `isotropic` is the square of a
    difference below which the tangent is (1, 0). Raises ValueError for an unknown encoding.
    """
    return decoding(encoding).widths(x, y, z, isotropic)


def decode_entries(
    encoding: str, x: Scalar, y: Scalar, z: Scalar, isotropic: float = NO_DIFFERENCE
) -> Entries:
    """Return (Sxx, Sxy, Syy, P) of a texel, P = αtαb: all that D and Smith's masking need.

    D = P³/(π(Syy hx² − 2Sxy hx hy + Sxx hy² + P² hz²)²). The matrix is positive definite for every
    texel. Raises ValueError for an unknown encoding.
    """
    return decoding(encoding).entries(x, y, z, isotropic)


def decoding(encoding: str) -> Decoding:
    """Return the decoders of an encoding. Raises ValueError for an unknown name."""
    if encoding not in DECODINGS:
        raise ValueError(f"no encoding is called {encoding!r}: allowed are {', '.join(DECODINGS)}")
    return DECODINGS[encoding]


def _clamped(value: Scalar, lower: float, upper: float) -> Array:
    return jnp.maximum(jnp.minimum(value, upper), lower)


def _half_angle(cos2: Array, sin2: Array) -> tuple[Array, Array]:
    """Return (cos θ, sin θ), cos θ ≥ 0, from those of 2θ. Neither is a root of a difference."""
    larger = jnp.sqrt(0.5 + 0.5 * jnp.abs(cos2))
    smaller = sin2 / (2 * larger)
    along = cos2 >= 0
    cos = jnp.where(along, larger, jnp.abs(smaller))
    return cos, jnp.where(along, smaller, jnp.where(sin2 < 0, -larger, larger))


# --- Correlations: √Sxx and √Syy are stored, and ρ in two ways --------------------------------


def _published(y: Scalar) -> tuple[Array, Array, Array]:
    """Return ρ, √(1 − ρ²) and 1 − √(1 − ρ²), which is not found as a difference."""
    rho = _clamped(2 * y - 1, -_LARGEST_RHO, _LARGEST_RHO)
    across = jnp.sqrt((1 - rho) * (1 + rho))
    return rho, across, rho * rho / (1 + across)


def _stereographic(y: Scalar) -> tuple[Array, Array, Array]:
    u = _clamped(2 * y - 1, -_LARGEST_U, _LARGEST_U)
    factor = 1 / (1 + u * u)
    return 2 * u * factor, (1 - u) * (1 + u) * factor, 2 * u * u * factor


def _correlated(name: str, correlation: Callable[[Scalar], tuple[Array, Array, Array]]) -> Decoding:
    def widths(x, y, z, isotropic=NO_DIFFERENCE):
        x, z = (_clamped(each, LEAST_ALPHA, 1.0) for each in (x, z))
        rho, across, lack = correlation(y)
        # (αt ± αb)² = Sxx + Syy ± 2αtαb, in which nothing cancels
        gap, product = x - z, 2 * x * z
        difference2 = gap * gap + product * lack
        total = jnp.sqrt(gap * gap + product * (1 + across))
        equal = difference2 <= isotropic
        difference = jnp.sqrt(jnp.where(equal, 1.0, difference2))
        alpha_t = 0.5 * (total + jnp.where(equal, 0.0, difference))
        alpha_b = 0.5 * product * across / alpha_t
        cos2 = jnp.where(equal, 1.0, (gap / difference) * ((x + z) / total))
        sin2 = jnp.where(equal, 0.0, (product * rho / difference) / total)
        ends = _clamped(alpha_t, LEAST_ALPHA, 1.0), _clamped(alpha_b, LEAST_ALPHA, 1.0)
        return (*ends, *_half_angle(cos2, sin2))

    def entries(x, y, z, isotropic=NO_DIFFERENCE):
        x, z = (_clamped(each, LEAST_ALPHA, 1.0) for each in (x, z))
        rho, across, _ = correlation(y)
        return x * x, x * z * rho, z * z, x * z * across

    return Decoding(name, widths, entries)


# --- Pauli components: a function f of S is stored as (m, d cos 2θ, d sin 2θ), m ± d = f(α) ----


def _signed(channel: Scalar) -> Array:
    return (_clamped(channel, 0.0, 1.0) - CENTRE) * (1 / SPREAD)


def _components(x, y, z, isotropic, least: float):
    """Return m, d with least ≤ m − d and m + d ≤ 1, cos 2θ and sin 2θ."""
    mean = _clamped(x, least, 1.0)
    along, across = (_signed(each) for each in (y, z))
    length2 = along * along + across * across
    equal = length2 <= isotropic
    length = jnp.sqrt(jnp.where(equal, 1.0, length2))
    cos2 = jnp.where(equal, 1.0, along / length)
    sin2 = jnp.where(equal, 0.0, across / length)
    largest = jnp.minimum(mean - least, 1 - mean)
    return mean, jnp.minimum(jnp.where(equal, 0.0, length), largest), cos2, sin2


def _root_widths(x, y, z, isotropic=NO_DIFFERENCE):
    mean, half, cos2, sin2 = _components(x, y, z, isotropic, _LEAST_ROOT)
    root_t, root_b = mean + half, mean - half
    return (root_t * root_t, root_b * root_b, *_half_angle(cos2, sin2))


def _root_entries(x, y, z, isotropic=NO_DIFFERENCE):
    mean = _clamped(x, _LEAST_ROOT, 1.0)
    along, across = (_signed(each) for each in (y, z))
    length2 = along * along + across * across
    largest = jnp.minimum(mean - _LEAST_ROOT, 1 - mean)
    within = length2 <= largest * largest
    scale = jnp.where(within, 1.0, largest / jnp.sqrt(jnp.maximum(length2, _SHORT2)))
    along, across, half2 = along * scale, across * scale, length2 * (scale * scale)
    # R = Q², and S = R²: sums of squares
    first, second = mean + along, mean - along
    r_xx, r_yy = first * first + across * across, second * second + across * across
    r_xy = 2 * mean * across
    square, root = r_xy * r_xy, mean * mean - half2
    s_xy = r_xy * (r_xx + r_yy)
    return r_xx * r_xx + square, s_xy, r_yy * r_yy + square, root * root


def _log_widths(x, y, z, isotropic=NO_DIFFERENCE):
    mean, half, cos2, sin2 = _components(x, y, z, isotropic, 0.0)
    scale = log(LEAST_LOGARITHMIC)
    alpha_t = jnp.exp(scale * (1 - (mean + half)))
    alpha_b = jnp.exp(scale * (1 - (mean - half)))
    return (alpha_t, alpha_b, *_half_angle(cos2, sin2))


def _log_entries(x, y, z, isotropic=NO_DIFFERENCE):
    alpha_t, alpha_b, cos, sin = _log_widths(x, y, z, isotropic)
    tt, bb = alpha_t * cos, alpha_b * sin
    tb, bt = alpha_t * sin, alpha_b * cos
    s_xy = (alpha_t - alpha_b) * (alpha_t + alpha_b) * cos * sin
    return tt * tt + bb * bb, s_xy, tb * tb + bt * bt, alpha_t * alpha_b


DECODINGS: dict[str, Decoding] = {
    each.name: each
    for each in (
        _correlated("published", _published),
        _correlated("stereographic", _stereographic),
        Decoding("quarter-root", _root_widths, _root_entries),
        Decoding("logarithmic", _log_widths, _log_entries),
    )
}
ENCODINGS = tuple(DECODINGS)
