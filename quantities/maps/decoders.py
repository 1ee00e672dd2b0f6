"""Decoders of anisotropic roughness from three channels of a texture, as functions to export.

A decoder is declared as a quantity whose closed form has four results, as a sampler is. It has no
forms, and no command but those for code knows it. Its code is verified at texels that stand for
widths and angles.
"""

import functools

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from integrals.reference import Axis, Estimate, Reference, leg
from integrals.sampling import Sampling
from programs.functions import Function, Parameter, Record, function
from quantities.calling_convention import CallingConvention
from quantities.problem import ExactCode, Problem
from shading.maps.encodings import (
    CENTRE,
    DECODINGS,
    LEAST_LOGARITHMIC,
    NO_DIFFERENCE,
    NO_DIFFERENCE_HALF,
    SPREAD,
    Decoding,
)

# Code is verified for widths from 0.03, at some distance from where the tangent changes its sign or
# is not defined. There rounding decides, and exported code may rightly differ.
_LEAST = 0.03
_MARGIN = 0.1
AXES = (
    Axis("alpha_t", 0.04, 1.0, "αt", meaning="roughness along the tangent", scale="logarithmic"),
    Axis("share", 0.0, 0.8, "s", meaning="αb = 0.03 (αt/0.03)^s, the roughness across it"),
    Axis("theta", _MARGIN - np.pi / 2, np.pi / 2 - _MARGIN, "θ", "rad", "angle of the tangent"),
)
# The relative error of the closed forms in float64: some roundings
_ROUNDING = 1e-13
_RECORDS = {"widths": Record("AnisoWidths", "array", "w"), "matrix": Record("AnisoMatrix")}
_RESULTS = {"widths": "w", "matrix": "m"}
_SUMMARIES = {
    "widths": "Widths w[0] >= w[1] of a texel, and the cosine and sine of its tangent's angle.",
    "matrix": "Matrix of a texel: m[0] = Sxx, m[1] = Sxy, m[2] = Syy, m[3] = alphaT alphaB.",
}
_REMARKS = {
    "widths": "The tangent of the larger width w[0] is w[2] times the tangent of the frame plus "
    "w[3] times its bitangent; for an isotropic texel it is (1, 0). x, y and z may be any numbers: "
    "they are clamped to [0, 1], and the widths to [0.01, 1]",
    "matrix": "D = m[3]^3/(pi (m[2] hx^2 - 2 m[1] hx hy + m[0] hy^2 + m[3]^2 hz^2)^2) in the frame "
    "of the normal. x, y and z may be any numbers: they are clamped to [0, 1], and the matrix is "
    "positive definite",
}


def _texel(name: str, alpha_t, alpha_b, theta) -> tuple[Array, Array, Array]:
    """Return the channels of a texel. `shading.maps.encode` has the same for arrays in NumPy."""
    if name in ("published", "stereographic"):
        cos, sin = jnp.cos(theta), jnp.sin(theta)
        x, z = jnp.hypot(alpha_t * cos, alpha_b * sin), jnp.hypot(alpha_t * sin, alpha_b * cos)
        rho = (alpha_t - alpha_b) * (alpha_t + alpha_b) * cos * sin / (x * z)
        across = 1 + alpha_t * alpha_b / (x * z) if name == "stereographic" else 1.0
        return x, 0.5 + 0.5 * rho / across, z
    if name == "quarter-root":
        first, second = jnp.sqrt(alpha_t), jnp.sqrt(alpha_b)
    else:
        first, second = (
            1 - jnp.log(each) / np.log(LEAST_LOGARITHMIC) for each in (alpha_t, alpha_b)
        )
    half = SPREAD * (first - second) / 2
    along, across = half * jnp.cos(2 * theta), half * jnp.sin(2 * theta)
    return (first + second) / 2, CENTRE + along, CENTRE + across


def _texel_at(name: str, alpha_t, share, theta) -> tuple[Array, Array, Array]:
    return _texel(name, alpha_t, _LEAST * (alpha_t / _LEAST) ** share, theta)


@functools.partial(jax.jit, static_argnums=0)
def _texels(name: str, points: Array) -> Array:
    """Return the channels (n, 3) of the texels at points (n, axes)."""
    return jax.vmap(lambda point: jnp.stack(_texel_at(name, *point)))(points)


def _decoder_function(decoding: Decoding, what: str, precision: str) -> Function:
    isotropic = NO_DIFFERENCE_HALF if precision == "half" else NO_DIFFERENCE
    call = decoding.widths if what == "widths" else decoding.entries

    def decode(x, y, z):
        return call(x, y, z, isotropic)

    parameters = [Parameter(each, (0.0, 1.0)) for each in "xyz"]
    word = "".join(part.capitalize() for part in decoding.name.split("-"))
    name = f"DecodeAniso{word}{'Matrix' if what == 'matrix' else ''}"
    return function(name, parameters, decode, _SUMMARIES[what], 4, _RESULTS[what], _RECORDS[what])


def _decoder(decoding: Decoding, what: str) -> Problem:
    call = decoding.widths if what == "widths" else decoding.entries

    @leg(*AXES)
    def closed_form(*point):
        return Estimate(jnp.stack(call(*_texel_at(decoding.name, *point))), jnp.asarray(_ROUNDING))

    key = f"aniso-{decoding.name}" + ("-matrix" if what == "matrix" else "")
    symbol = "(αt, αb, t)" if what == "widths" else "(S, αtαb)"
    meaning = (
        "the widths and the tangent"
        if what == "widths"
        else "the matrix and its determinant's root"
    )
    reference = Reference(
        key,
        symbol,
        f"{meaning} of a texel of anisotropic roughness in the {decoding.name} encoding",
        "S = αt² t tᵀ + αb² b bᵀ",
        AXES,
        Sampling(10, 10, 10),
        closed_form=closed_form,
    )
    exact = ExactCode(
        "closed form",
        AXES,
        lambda precision: (_decoder_function(decoding, what, precision),),
        lambda points: (np.asarray(_texels(decoding.name, points)),),
        _REMARKS[what],
    )
    return Problem(reference, (), CallingConvention(key, "", ()), exact_code=exact)


# By name; the decoders of an encoding follow each other.
DECODERS: dict[str, Problem] = {
    each.name: each
    for decoding in DECODINGS.values()
    for each in (_decoder(decoding, "widths"), _decoder(decoding, "matrix"))
}
