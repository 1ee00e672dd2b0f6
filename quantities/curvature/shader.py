"""Curvature from light, packing and unpacking, as functions to export.

They are declared as quantities whose closed form is the function itself. They have no forms, and
no command but those for code knows them.
"""

from collections.abc import Callable, Sequence

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jax.ad_checkpoint import checkpoint_name

from integrals.reference import Axis, Estimate, Reference, leg
from integrals.sampling import Sampling
from programs.functions import Function, Parameter, function
from quantities.calling_convention import CallingConvention, clamped
from quantities.problem import ExactCode, Problem
from shading.curvature import (
    along_light,
    effective,
    equivalent_cylinder,
    packed,
    published,
    tangent_frame,
    unpacked,
)
from shading.curvature.packing import LARGEST_CODE, RANGE
from shading.directions import direction

# Code takes tensors up to this curvature in 1/mm, and clamps others to it.
LARGEST = 8.0
# The relative error of these formulas in float64: some roundings
_ROUNDING = 1e-14
_TENSOR = (
    Axis("xx", -RANGE, RANGE, "II_tt", "1/mm", "entry of the tangent"),
    Axis("xy", -RANGE, RANGE, "II_tb", "1/mm", "entry of tangent and bitangent"),
    Axis("yy", -RANGE, RANGE, "II_bb", "1/mm", "entry of the bitangent"),
)
_DIRECTIONS = (
    Axis("theta_n", 0.0, np.pi, "θn", "rad", "polar angle of the normal"),
    Axis("phi_n", -np.pi, np.pi, "φn", "rad", "azimuth of the normal", period=2 * np.pi),
    Axis("theta_l", 0.0, np.pi, "θl", "rad", "polar angle of the light"),
    Axis("phi_l", -np.pi, np.pi, "φl", "rad", "azimuth of the light", period=2 * np.pi),
)
_CODES = tuple(
    Axis(f"code{k}", -float(LARGEST_CODE), float(LARGEST_CODE), f"c{k}", meaning=f"byte {k}")
    for k in range(4)
)
_UNIT = (-1.0, 1.0)
_VECTORS = tuple(
    Parameter(f"{name}{axis}", _UNIT) for name in ("tangent", "bitangent") for axis in "XYZ"
)
_ENTRIES = tuple(Parameter(name, (-LARGEST, LARGEST), "1/mm") for name in ("IIx", "IIy", "IIz"))
_LIGHT = tuple(Parameter(f"light{axis}", _UNIT) for axis in "XYZ")

# n·l, which the drift of the normal may take beyond 1
_COSINE = Parameter("NdotL", (-2.0, 2.0))

Method = Callable[[Array, Array], Array]


def _from_light(name: str, method: Method, summary: str) -> Function:
    def value(*given):
        return method(*_tensor_and_light(given))

    return function(name, (*_VECTORS, *_ENTRIES, *_LIGHT), value, summary)


def _tensor_and_light(given: Sequence[Array]) -> tuple[Array, Array]:
    """Return the tensor and the projected light of tangent, bitangent, tensor and light."""
    tangent, bitangent, tensor, light = (given[k : k + 3] for k in (0, 3, 6, 9))
    entries = jnp.stack([clamped(each, -LARGEST, LARGEST) for each in tensor])
    along = [
        checkpoint_name(clamped(_dot(light, axis), *_UNIT), name)
        for axis, name in ((tangent, "alongTangent"), (bitangent, "alongBitangent"))
    ]
    return entries, jnp.stack(along)


def _dot(one: Sequence[Array], other: Sequence[Array]) -> Array:
    return one[0] * other[0] + one[1] * other[1] + one[2] * other[2]


def _pack(*given):
    tensor, largest = given[:3], given[3]
    bounded = jnp.stack([clamped(each, -LARGEST, LARGEST) for each in tensor])
    return tuple(packed(bounded, clamped(largest, 1 / 64, LARGEST)))


def _unpack(*given):
    codes = jnp.stack([clamped(each, -128.0, float(LARGEST_CODE)) for each in given[:4]])
    return tuple(unpacked(codes, clamped(given[4], 1 / 64, LARGEST)))


_RANGE = Parameter("largest", (1 / 64, LARGEST), "1/mm")
_PACK = function(
    "PackCurvature",
    (*_ENTRIES, _RANGE),
    _pack,
    "Whole numbers from -127 to 127: the tensor of the range, and the mean curvature.",
    4,
    "codes",
)
_UNPACK = function(
    "UnpackCurvature",
    (*(Parameter(f"code{k}", (-128.0, 127.0)) for k in range(4)), _RANGE),
    _unpack,
    "The tensor in w[0..2] and the mean curvature in w[3], of four signed bytes.",
    4,
    "w",
)


@jax.jit
def _light_arguments(points: Array) -> Array:
    """Return frames (6), tensors (3) and lights (3) at points (n, 7)."""

    def row(point):
        frame = tangent_frame(direction(point[0], point[1]))
        return jnp.concatenate([frame.ravel(), point[4:7], direction(point[2], point[3])])

    return jax.vmap(row)(points)


_REMARK = (
    "tangent and bitangent are orthogonal unit vectors in the surface, light is the unit one "
    "to the light. II is the curvature tensor (tangent, mixed, bitangent) in 1/mm, positive "
    "where the surface is convex"
)


def _light_problem(key: str, method: Method, called: str, summary: str, definition: str) -> Problem:
    axes = (*_DIRECTIONS, *_TENSOR)

    @leg(*axes)
    def closed_form(*point):
        frame = tangent_frame(direction(point[0], point[1]))
        value = method(jnp.stack(point[4:7]), frame @ direction(point[2], point[3]))
        return Estimate(value, jnp.asarray(_ROUNDING))

    remark = f"{_REMARK}. A fit of diffusion takes the absolute value of the result"
    made = _from_light(called, method, summary)
    return _problem(
        key, "κ", summary, definition, axes, closed_form, made, _light_arguments, remark
    )


def _cylinder_value(*given):
    return tuple(equivalent_cylinder(*_tensor_and_light(given), clamped(given[12], -2.0, 2.0)))


_CYLINDER = function(
    "EquivalentCylinder",
    (*_VECTORS, *_ENTRIES, *_LIGHT, _COSINE),
    _cylinder_value,
    "The cosine and the curvature for a fit of D in w[0] and w[1], and the scale of D in w[2].",
    3,
    "w",
)


def _cylinder_problem() -> Problem:
    axes = (*_DIRECTIONS, *_TENSOR)

    def parts(point):
        normal = direction(point[0], point[1])
        frame, light = tangent_frame(normal), direction(point[2], point[3])
        return frame, light, normal @ light

    @leg(*axes)
    def closed_form(*point):
        frame, light, cosine = parts(point)
        found = equivalent_cylinder(jnp.stack(point[4:7]), frame @ light, cosine)
        return Estimate(jnp.stack(found), jnp.asarray(_ROUNDING))

    def arguments(points):
        given = _light_arguments(points)
        cosines = jax.vmap(lambda point: parts(point)[2])(points)
        return jnp.concatenate([given, cosines[:, None]], axis=1)

    return _problem(
        "equivalent-cylinder",
        "s",
        "The lit cylinder that stands for a curved surface in a light",
        "s² = c² + |II l_t|²/‖II‖² with c = n·l, l_t = (l·t, l·b); the light is s D(c/s, ‖II‖)",
        axes,
        closed_form,
        _CYLINDER,
        jax.jit(arguments),
        "NdotL is not clamped at 0. To it may be added the variance of the channel times the drift "
        "of the normal along the light. The result for a fit is w[2] D(w[0], w[1]). " + _REMARK,
    )


def _packing_problems() -> tuple[Problem, Problem]:
    ranged = Axis("range", 0.125, 1.0, "κ_max", "1/mm", "largest curvature that is stored")

    @leg(*_TENSOR, ranged)
    def packing(*point):
        codes = packed(jnp.stack(_between(point)), point[3])
        return Estimate(codes, jnp.asarray(_ROUNDING))

    @leg(*_CODES, ranged)
    def unpacking(*point):
        return Estimate(unpacked(jnp.stack(point[:4]), point[4]), jnp.asarray(_ROUNDING))

    pack = _problem(
        "pack",
        "c",
        "a curvature tensor in four signed bytes",
        "c = ⌊127 II/κ_max + ½⌋, and that of the mean curvature",
        (*_TENSOR, ranged),
        packing,
        _PACK,
        jax.jit(jax.vmap(lambda point: jnp.stack([*_between(point), point[3]]))),
        "codes are stored as bytes c, or as c/127 in a signed normalised format; entries of the "
        "tensor beyond the range are clamped",
    )
    unpack = _problem(
        "unpack",
        "II",
        "a curvature tensor of four signed bytes",
        "II = κ_max c/127",
        (*_CODES, ranged),
        unpacking,
        _UNPACK,
        lambda points: points,
        "codes are whole numbers: 127 times the value of a signed normalised vertex format",
    )
    return pack, unpack


def _between(point) -> list[Array]:
    """Return the tensor of codes that are whole, moved by a fifth of a step.

    At half a step, rounding decides between two codes, and exported code may rightly differ.
    """
    step = point[3] / LARGEST_CODE
    whole = [jnp.floor(each / step) for each in (point[0], point[1], point[2])]
    return [(each + 0.2) * step for each in whole]


def _problem(key, symbol, meaning, definition, axes, closed_form, made, arguments, remark):
    reference = Reference(
        key, symbol, meaning, definition, axes, Sampling(10, 10, 10), closed_form=closed_form
    )
    exact = ExactCode(
        "closed form",
        axes,
        lambda _: (made,),
        lambda points: (np.asarray(arguments(points)),),
        remark,
        "none but the rounding of float64",
    )
    return Problem(reference, (), CallingConvention(key, "", ()), exact_code=exact)


# By name.
CURVATURES: dict[str, Problem] = {
    each.name: each
    for each in (
        _light_problem(
            "from-light",
            published,
            "CurvatureFromLight",
            "Curvature along a light, not normalised, as the talk has it",
            "κ = l_tᵀ II l_t with l_t = (l·t, l·b)",
        ),
        _light_problem(
            "along-light",
            along_light,
            "CurvatureAlongLight",
            "Curvature of the surface along a light, normalised; the mean for a light along n",
            "κ = l_tᵀ II l_t / |l_t|² with l_t = (l·t, l·b)",
        ),
        _light_problem(
            "effective",
            effective,
            "EffectiveCurvatureFromLight",
            "Curvature by which a light is spread over a blurred patch",
            "κ² = |II l_t|² + (n·l)² ‖II‖² with l_t = (l·t, l·b)",
        ),
        _cylinder_problem(),
        *_packing_problems(),
    )
}
