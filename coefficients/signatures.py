"""How each quantity is called in a shader: the paper's names, arguments and clamps.

The expressions are those of the forms that were fitted: here they only get their arguments' names,
domains and clamps. The forms are called with NumPy's constants, which the printer writes into the
code.
"""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from fitting import Form
from fitting.paper import RationalPs, direction_basis
from integrals import Axis
from programs.function import Function, Parameter, function

COSINE = (0.0, 1.0)
# c₀ … c₅ of both tables of P_s lie within it for every material.
_MATERIAL = (-3.0, 3.0)


def signature(form: Form) -> tuple[Function, ...]:
    """Give the functions that a form is exported as, in the order of their calls.

    One function; for P_s two, `CalcFuzzPsCoeffs` for a material and `FuzzPs` for a direction.
    """
    build = _of_ps if isinstance(form, RationalPs) else _BUILDERS[form.integral.name]
    return build(type(form), np.asarray(form.coefficients, np.float64))


def arguments(quantity: str, points: np.ndarray) -> tuple[np.ndarray, ...]:
    """Give what the functions are called with at points (n, axes) of a quantity's forms.

    One array (n, …) for each function in turn, without the results of the one before it.
    """
    return _COLUMNS.get(quantity, _all_columns)(points)


def _domain(axis: Axis) -> tuple[float, float]:
    return float(axis.lower), float(axis.upper)


def _clamp(value: Any, low: float | None, high: float) -> Any:
    if low is None:
        return jnp.minimum(value, high)
    return jnp.maximum(jnp.minimum(value, high), low)


def _name_terms(alpha: Any, theta_f: Any) -> tuple[Any, Any, Any]:
    """Name β, γ and δ as the listings do: equal expressions of the form take these names over."""
    b = 1 - alpha
    g = jnp.cos(theta_f)
    d = jnp.sin(theta_f)
    return b, g, d


def _of_ps(form: type[Form], coefficients: np.ndarray) -> tuple[Function, ...]:
    alphas, thetas = map(_domain, form.axes[:2])

    def material(alpha, theta_f):
        theta_f = _clamp(theta_f, *thetas)
        alpha = _clamp(alpha, *alphas)
        _name_terms(alpha, theta_f)
        return tuple(_with(form, coefficients).material(alpha, theta_f))

    def value(c, cos_un, cos_ut):
        return sum(c_i * term for c_i, term in zip(c, direction_basis(cos_un, cos_ut), strict=True))

    return (
        function(
            "CalcFuzzPsCoeffs",
            (Parameter("alpha", alphas), Parameter("thetaF", thetas, "rad")),
            material,
            "Coefficients c of FuzzPs for one material (Eq. 2); clamps to the domain.",
            6,
            "c",
        ),
        function(
            "FuzzPs",
            (
                Parameter("c", _MATERIAL, size=6),
                Parameter("NdotU", COSINE),
                Parameter("TdotU", (-1.0, 1.0)),
            ),
            value,
            "P_s for one direction of light (Eq. 1): c[3] goes with (u·n)², c[4] with (u·n)(u·t).",
        ),
    )


def _of_material(form: type[Form], coefficients: np.ndarray) -> tuple[Function, ...]:
    """Export a form of P_s in its two parts; the material's numbers are the form's own."""
    alphas, thetas = map(_domain, form.axes[:2])
    fitted = _with(form, coefficients)
    nodes = np.meshgrid(np.linspace(*alphas, 33), np.linspace(*thetas, 33))
    sampled = jax.jit(jax.vmap(lambda a, t: jnp.stack(fitted.material(a, t))))
    largest = float(np.max(np.abs(sampled(*(each.ravel() for each in nodes)))))

    def material(alpha, theta_f):
        theta_f = _clamp(theta_f, *thetas)
        alpha = _clamp(alpha, *alphas)
        return tuple(_with(form, coefficients).material(alpha, theta_f))

    def value(c, cos_un, cos_ut):
        return _with(form, coefficients).along(c, cos_un, cos_ut)

    count = len(fitted.material(alphas[0], thetas[0]))
    return (
        function(
            "CalcFuzzPsCoeffs",
            (Parameter("alpha", alphas), Parameter("thetaF", thetas, "rad")),
            material,
            "What FuzzPs needs to know of one material; clamps to the domain.",
            count,
            "c",
        ),
        function(
            "FuzzPs",
            (
                Parameter("c", (-largest, largest), size=count),
                Parameter("NdotU", COSINE),
                Parameter("TdotU", (-1.0, 1.0)),
            ),
            value,
            "P_s for one direction of light.",
        ),
    )


def _of_g(form: type[Form], coefficients: np.ndarray) -> tuple[Function, ...]:
    densities, cosines = map(_domain, form.axes)

    def value(cos_v, density):
        density = _clamp(density, None, densities[1])
        return _with(form, coefficients)(density, cos_v)

    parameters = (Parameter("NdotV", cosines), Parameter("density", densities))
    summary = f"G ({_printed(form)}); clamps density from above."
    return (function("FuzzGApprox", parameters, value, summary),)


def _of_q(form: type[Form], coefficients: np.ndarray) -> tuple[Function, ...]:
    domain = _domain(form.axes[0])

    def value(density):
        density = _clamp(density, None, domain[1])
        return _with(form, coefficients)(density)

    summary = f"Q ({_printed(form)}); clamps density from above."
    name = "FuzzAveragePenetration"
    return (function(name, (Parameter("density", domain),), value, summary),)


def _of_r(form: type[Form], coefficients: np.ndarray) -> tuple[Function, ...]:
    alphas, thetas = map(_domain, form.axes)

    def value(alpha, theta_f):
        theta_f = _clamp(theta_f, *thetas)
        alpha = _clamp(alpha, *alphas)
        _name_terms(alpha, theta_f)
        return _with(form, coefficients)(alpha, theta_f)

    parameters = (Parameter("alpha", alphas), Parameter("thetaF", thetas, "rad"))
    summary = f"R ({_printed(form)}); clamps to the domain."
    return (function("FuzzAveragePs", parameters, value, summary),)


def _of_velvet(form: type[Form], coefficients: np.ndarray) -> tuple[Function, ...]:
    domain = _domain(form.axes[0])

    def value(asymmetry):
        return _with(form, coefficients)(_clamp(asymmetry, *domain))

    summary = "r(k), which scales the velvet phase function, from below; clamps to the domain."
    return (function("FuzzVelvetNorm", (Parameter("asymmetry", domain),), value, summary),)


def _printed(form: type[Form]) -> str:
    """Give the equation that the paper prints a form by, or the form's name."""
    return form.equation.replace("Eq. (", "Eq. ").rstrip(")") if form.shape is None else form.name


def _with(form: type[Form], coefficients: np.ndarray) -> Any:
    return form(jnp.asarray(coefficients))


def light_cosines(points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Give u·n, u·t and n·t, (n,) each, of points (n, 4) of (α, θf, θu, φ)."""
    _, theta_f, theta_u, phi = points.T
    cos_un, cos_nt = np.cos(theta_u), np.cos(theta_f)
    cos_ut = np.sin(theta_u) * np.cos(phi) * np.sin(theta_f) + cos_un * cos_nt
    return cos_un, cos_ut, cos_nt


def _all_columns(points: np.ndarray) -> tuple[np.ndarray, ...]:
    return (points,)


def _ps_columns(points: np.ndarray) -> tuple[np.ndarray, ...]:
    cos_un, cos_ut, _ = light_cosines(points)
    return points[:, :2], np.stack([cos_un, cos_ut], axis=1)


# Forms of the families are called as the paper's are: code that calls one may call the other.
_BUILDERS = {"ps": _of_material, "g": _of_g, "q": _of_q, "r": _of_r, "velvet": _of_velvet}
# How the functions are called at points of the form's axes, where their order differs.
_COLUMNS = {"ps": _ps_columns, "g": lambda points: (points[:, ::-1],)}
REMARKS = {
    "ps": "alpha, the roughness, is the projected area along the fibre t, thetaF its polar angle: "
    "turn t so that NdotT >= 0; NdotU = u·n and TdotU = u·t of the light's direction u. What is "
    "proven holds for cosines of unit vectors",
    "g": "NdotV = v·n of the view's direction v; density = NdotV = 0 is 0/0",
    "q": "density is thickness over mean free path",
    "r": "alpha, the roughness, is the projected area along the fibre, thetaF its polar angle",
    "velvet": "asymmetry is k of Schlick's lobe p_Schlick(k, -sin(t, h)), whose factor r is",
}
