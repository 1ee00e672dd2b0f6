"""The form of E_lit that needs two numbers and P_s, and has both limits built in.

E_lit is the mean of σ(v)/σ(u) over the visible normals of v that reflect it upwards, times their
part 1 − P_s. 1/√(1 − κā²) stands for the mean of 1/σ(u), where ā² is a mean of (u·t)².
"""

import jax.numpy as jnp
import numpy as np
from jax import Array

from fitting.form import Form, Proofs, Stage
from integrals.fuzz.lit import E_LIT
from integrals.fuzz.ps import fraction_at
from integrals.reference import Axis, restricted
from shading import direction_cosines
from shading.types import Scalar

LEAST_ALPHA = 0.05
# The axes of proofs: the form depends on a point through v·t and P_s only.
COS_VT = Axis("cos_vt", -1.0, 1.0, "v·t")
SCATTERED = Axis("scattered", 0.0, 1.0, "P_s")
# A lower limit of the divisor, which changes no value for arguments in their domains.
_LEAST = 1e-6


def _material(c, alpha: Scalar) -> tuple[Array, ...]:
    """Return κ, 1 − C[0]·α and C[1]·α."""
    alpha = jnp.asarray(alpha)
    return (1 - alpha) * (1 + alpha), 1 - c[0] * alpha, c[1] * alpha


def _divisor(m: tuple, cos_vt: Scalar, up: Scalar) -> Array:
    return 1 - m[0] * (cos_vt * cos_vt * m[1] + m[2] * up)


def _along(m: tuple, cos_vt: Scalar, scattered: Scalar) -> Array:
    up = 1 - jnp.asarray(scattered)
    return up * jnp.sqrt((1 - m[0] * (cos_vt * cos_vt)) / _divisor(m, cos_vt, up))


def _limited(m: tuple, cos_vt: Scalar, scattered: Scalar) -> Array:
    up = 1 - jnp.asarray(scattered)
    below = jnp.maximum(_divisor(m, cos_vt, up), _LEAST)
    return up * jnp.sqrt((1 - m[0] * (cos_vt * cos_vt)) / below)


def seen(alpha: Scalar, theta_f: Scalar, theta_v: Scalar, phi: Scalar) -> tuple[Array, Array]:
    """Return v·t and P_s(v) at a point."""
    _, cos_vt = direction_cosines(theta_f, theta_v, jnp.cos(phi))
    return cos_vt, fraction_at(alpha, theta_f, theta_v, phi)


def _positive(c, alpha: Scalar, theta_f: Scalar, theta_v: Scalar, phi: Scalar) -> Array:
    cos_vt, scattered = seen(alpha, theta_f, theta_v, phi)
    return _divisor(_material(c, alpha), cos_vt, 1 - scattered)


_AXES = restricted(E_LIT.axes, alpha=(LEAST_ALPHA, 1.0))

AREA_RATIO = Form(
    name="area-ratio-lit",
    equation="E_lit = (1 − P_s)·√((1 − κa²)/(1 − κ(a²(1 − C[0]·α) + C[1]·α·(1 − P_s)))), "
    "κ = 1 − α², a = v·t",
    reference=E_LIT,
    axes=_AXES,
    coefficient_names=["c0: a²α", "c1: α(1 − P_s)"],
    stages=(
        Stage(
            _material,
            "What {name} needs to know of one material; clamps to the domain.",
            result_name="m",
        ),
        Stage(
            _along,
            "E_lit for one view; clamps to the domain.",
            arguments=("a", "scattered"),
            limited=_limited,
        ),
    ),
    shared=1,
    inputs=seen,
    starts=(np.array([1.0, 0.5]),),
    proofs=Proofs(
        axes=(_AXES[0], COS_VT, SCATTERED),
        inputs=lambda _, cos_vt, scattered: (cos_vt, scattered),
        value=lambda c, alpha, cos_vt, scattered: _along(_material(c, alpha), cos_vt, scattered),
        positive=_positive,
        first_split=(64, 8, 2),
    ),
    has_least_error=False,
)
