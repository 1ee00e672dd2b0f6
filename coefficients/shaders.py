"""What is exported of a table: the paper's functions, with the clamps of its listings.

The expressions are those of the forms that were fitted and of the closed form: here they only get
their arguments' names, domains and clamps. The forms are called with NumPy's constants, which the
printer writes into the code.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from coefficients.catalogue import form_of, load
from coefficients.table import Table
from fitting import Form
from fitting.paper import direction_basis
from integrals import PS, Axis, Integral
from integrals.ps import FLOAT32_STEPS, FLOAT64_STEPS, scattered_fraction
from programs.function import Function, Parameter

EXACT_PS = "exact/ps"
# The least α whose error in float32 is stated.
LEAST_EXACT_ALPHA = 0.05
_HALF_PI = float(np.pi / 2)
_COSINE = (0.0, 1.0)
# c₀ … c₅ of both tables of P_s lie within it for every material.
_MATERIAL = (-3.0, 3.0)


@dataclass(frozen=True)
class Shader:
    """What is exported under a table's name: functions, and how they are called at a point.

    `functions` are called one after the other: each takes the results of the one before it,
    followed by its own entry of `columns(points)`, for points (n, axes) of `axes`. The last gives
    the value that approximates `integral`. `form` is what was fitted; None: the closed form.
    """

    quantity: str
    equation: str
    integral: Integral
    axes: tuple[Axis, ...]
    functions: tuple[Function, ...]
    columns: Callable[[np.ndarray], tuple[np.ndarray, ...]]
    form: Form | None = None
    remark: str | None = None


def functions_of(table: Table, name: str | None = None) -> tuple[Function, ...]:
    """Give the functions that a table is exported as, in the order of their calls.

    Arguments: `table`; `name`, what the function that gives the value is called instead of the
    paper's name (FuzzPs, FuzzGApprox, FuzzAveragePenetration, FuzzAveragePs). Returns one
    function; for P_s two, `Calc…Coeffs` for a material and the other for a direction. Raises
    ValueError for a form that is not known and a name that is no identifier.
    """
    form = form_of(table)
    build = _BUILDERS.get(
        table.form, _plain if table.shape is None else _OF_FAMILIES[table.quantity]
    )
    functions = build(type(form), np.asarray(table.coefficients, np.float64))
    return functions if name is None else _renamed(functions, name)


def exact_ps(precision: str = "float", name: str = "FuzzPsExact") -> tuple[Function, ...]:
    """Give the closed form of P_s as a function, with the root's steps that a precision needs.

    Arguments: `precision`, "half", "float" or "double"; `name`, what it is called. Returns one
    function of u·n, u·t, n·t and α. Raises ValueError for a name that is no identifier.
    """
    steps = FLOAT64_STEPS if precision == "double" else FLOAT32_STEPS

    def exact(cos_un, cos_ut, cos_nt, alpha):
        return scattered_fraction(cos_un, cos_ut, cos_nt, alpha, steps)

    parameters = (
        Parameter("NdotU", _COSINE),
        Parameter("TdotU", (-1.0, 1.0)),
        Parameter("NdotT", _COSINE),
        Parameter("alpha", (LEAST_EXACT_ALPHA, 1.0)),
    )
    return (function(name, parameters, exact, "P_s in closed form, without coefficients."),)


def function(
    name: str,
    parameters: Sequence[Parameter],
    call: Callable[..., Any],
    summary: str = "",
    result: int | None = None,
    result_name: str = "result",
) -> Function:
    """Make any JAX function of scalars one that can be exported, counted and verified.

    Arguments: `name` and `parameters` as the user of the shader sees them; `call`, in JAX;
    `summary`, one line for the comment above it; `result`, None for a scalar or how many numbers
    it gives, in an array called `result_name`. Returns the function. Raises ValueError for names
    that are no identifiers or occur twice.
    """
    return Function(name, summary or f"{name}.", tuple(parameters), result, result_name, call)


def shader(name: str, precision: str = "float", function_name: str | None = None) -> Shader:
    """Give what is exported under a name.

    Arguments: `name`, a table's name or path, or 'exact/ps'; `precision`, which decides how many
    steps the closed form takes; `function_name` as in `functions_of`. Raises ValueError for a name
    that stands for nothing, and as `functions_of` does.
    """
    if name == EXACT_PS:
        chosen = {} if function_name is None else {"name": function_name}
        return Shader(
            f"{PS.symbol}, {PS.meaning}",
            "closed form, root by tangent steps",
            PS,
            (replace(PS.axes[0], lower=LEAST_EXACT_ALPHA, open_below=False), *PS.axes[1:]),
            exact_ps(precision, **chosen),
            _exact_columns,
            remark="NdotU = u·n, TdotU = u·t, NdotT = n·t, all unit vectors; t and −t are one "
            "fibre: turn t so that NdotT >= 0",
        )
    table = load(name)
    form = form_of(table)
    integral = type(form).integral
    return Shader(
        f"{integral.symbol}, {integral.meaning}",
        table.equation,
        integral,
        type(form).axes,
        functions_of(table, function_name),
        _COLUMNS.get(table.quantity, _all_columns),
        form,
        _REMARKS.get(table.quantity),
    )


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
    def material(alpha, theta_f):
        theta_f = _clamp(theta_f, 0.1, _HALF_PI)
        alpha = _clamp(alpha, 0.15, 1.0)
        _name_terms(alpha, theta_f)
        return tuple(_with(form, coefficients).material(alpha, theta_f))

    def value(c, cos_un, cos_ut):
        return sum(c_i * term for c_i, term in zip(c, direction_basis(cos_un, cos_ut), strict=True))

    return (
        function(
            "CalcFuzzPsCoeffs",
            (Parameter("alpha", (0.15, 1.0)), Parameter("thetaF", (0.1, _HALF_PI), "rad")),
            material,
            "Coefficients c of FuzzPs for one material (Eq. 2); clamps to the domain.",
            6,
            "c",
        ),
        function(
            "FuzzPs",
            (
                Parameter("c", _MATERIAL, size=6),
                Parameter("NdotU", _COSINE),
                Parameter("TdotU", (-1.0, 1.0)),
            ),
            value,
            "P_s for one direction of light (Eq. 1): c[3] goes with (u·n)², c[4] with (u·n)(u·t).",
        ),
    )


def _of_material(form: type[Form], coefficients: np.ndarray) -> tuple[Function, ...]:
    """Export a form of P_s in its two parts; the material's numbers are the form's own."""
    alpha_axis, theta_axis = form.axes[:2]
    low, high = float(alpha_axis.lower), float(alpha_axis.upper)
    fitted = _with(form, coefficients)
    alphas, thetas = np.meshgrid(np.linspace(low, high, 33), np.linspace(0, _HALF_PI, 33))
    sampled = jax.jit(jax.vmap(lambda a, t: jnp.stack(fitted.material(a, t))))
    largest = float(np.max(np.abs(sampled(alphas.ravel(), thetas.ravel()))))

    def material(alpha, theta_f):
        theta_f = _clamp(theta_f, 0.0, _HALF_PI)
        alpha = _clamp(alpha, low, high)
        return tuple(_with(form, coefficients).material(alpha, theta_f))

    def value(c, cos_un, cos_ut):
        return _with(form, coefficients).along(c, cos_un, cos_ut)

    count = len(fitted.material(low, 0.0))
    return (
        function(
            "CalcFuzzPsCoeffs",
            (
                Parameter("alpha", (low, high)),
                Parameter("thetaF", (float(theta_axis.lower), _HALF_PI), "rad"),
            ),
            material,
            "What FuzzPs needs to know of one material; clamps to the domain.",
            count,
            "c",
        ),
        function(
            "FuzzPs",
            (
                Parameter("c", (-largest, largest), size=count),
                Parameter("NdotU", _COSINE),
                Parameter("TdotU", (-1.0, 1.0)),
            ),
            value,
            "P_s for one direction of light.",
        ),
    )


def _of_g(form: type[Form], coefficients: np.ndarray) -> tuple[Function, ...]:
    def value(cos_v, density):
        density = _clamp(density, None, 0.5)
        return _with(form, coefficients)(density, cos_v)

    parameters = (Parameter("NdotV", (0.001, 1.0)), Parameter("density", (0.001, 0.5)))
    summary = f"G ({_printed(form)}); clamps density from above."
    return (function("FuzzGApprox", parameters, value, summary),)


def _of_q(form: type[Form], coefficients: np.ndarray) -> tuple[Function, ...]:
    def value(density):
        density = _clamp(density, None, 0.5)
        return _with(form, coefficients)(density)

    summary = f"Q ({_printed(form)}); clamps density from above."
    name = "FuzzAveragePenetration"
    return (function(name, (Parameter("density", (0.0, 0.5)),), value, summary),)


def _of_r(form: type[Form], coefficients: np.ndarray) -> tuple[Function, ...]:
    low = float(form.axes[0].lower)

    def value(alpha, theta_f):
        theta_f = _clamp(theta_f, 0.0, _HALF_PI)
        alpha = _clamp(alpha, low, 1.0)
        _name_terms(alpha, theta_f)
        return _with(form, coefficients)(alpha, theta_f)

    parameters = (Parameter("alpha", (low, 1.0)), Parameter("thetaF", (0.0, _HALF_PI), "rad"))
    summary = f"R ({_printed(form)}); clamps to the domain."
    return (function("FuzzAveragePs", parameters, value, summary),)


def _of_velvet(form: type[Form], coefficients: np.ndarray) -> tuple[Function, ...]:
    low = float(form.axes[0].lower)

    def value(asymmetry):
        return _with(form, coefficients)(_clamp(asymmetry, low, 0.0))

    summary = "r(k), which scales the velvet phase function, from below; clamps to the domain."
    return (function("FuzzVelvetNorm", (Parameter("asymmetry", (low, 0.0)),), value, summary),)


def _printed(form: type[Form]) -> str:
    """Give the equation that the paper prints a form by, or the form's name."""
    return form.equation.replace("Eq. (", "Eq. ").rstrip(")") if form.shape is None else form.name


def _plain(form: type[Form], coefficients: np.ndarray) -> tuple[Function, ...]:
    """Export a form that the paper has no signature for under its own name and axes."""
    parameters = tuple(
        Parameter(axis.name, (float(axis.lower), float(axis.upper)), axis.unit)
        for axis in form.axes
    )
    summary = f"{form.integral.symbol} by {form.equation}."
    name = f"Fuzz{form.__name__}"

    def value(*arguments):
        return _with(form, coefficients)(*arguments)

    return (function(name, parameters, value, summary),)


def _with(form: type[Form], coefficients: np.ndarray) -> Any:
    return form(jnp.asarray(coefficients))


def _renamed(functions: tuple[Function, ...], name: str) -> tuple[Function, ...]:
    *before, last = functions
    renamed = [
        replace(each, name=f"Calc{name}Coeffs", summary=each.summary.replace(last.name, name))
        for each in before
    ]
    return (*renamed, replace(last, name=name))


def _light(points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Give u·n, u·t and n·t, (n,) each, of points (n, 4) of (α, θf, θu, φ)."""
    _, theta_f, theta_u, phi = points.T
    cos_un, cos_nt = np.cos(theta_u), np.cos(theta_f)
    cos_ut = np.sin(theta_u) * np.cos(phi) * np.sin(theta_f) + cos_un * cos_nt
    return cos_un, cos_ut, cos_nt


def _all_columns(points: np.ndarray) -> tuple[np.ndarray, ...]:
    return (points,)


def _ps_columns(points: np.ndarray) -> tuple[np.ndarray, ...]:
    cos_un, cos_ut, _ = _light(points)
    return points[:, :2], np.stack([cos_un, cos_ut], axis=1)


def _exact_columns(points: np.ndarray) -> tuple[np.ndarray, ...]:
    return (np.stack([*_light(points), points[:, 0]], axis=1),)


_BUILDERS = {
    "rational-ps": _of_ps,
    "rational-g": _of_g,
    "quadratic-q": _of_q,
    "rational-r": _of_r,
    "conservative-norm": _of_velvet,
}
# Forms of the families are called as the paper's are: code that calls one may call the other.
_OF_FAMILIES = {"ps": _of_material, "g": _of_g, "q": _of_q, "r": _of_r}
# How the functions are called at points of the form's axes, where their order differs.
_COLUMNS = {"ps": _ps_columns, "g": lambda points: (points[:, ::-1],)}
_REMARKS = {
    "ps": "alpha is the projected area along the fibre, thetaF its polar angle, "
    "NdotU = u·n and TdotU = u·t of the light's direction u",
    "g": "NdotV = v·n of the view's direction v; density = NdotV = 0 is 0/0",
    "q": "density is thickness over mean free path",
    "r": "alpha is the projected area along the fibre, thetaF its polar angle",
    "velvet": "asymmetry is k of Schlick's lobe p_Schlick(k, -sin(t, h)), whose factor r is",
}
