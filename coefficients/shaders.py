"""What is exported under a name: a table's functions, or the closed form of P_s."""

import functools
import os
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from coefficients.catalogue import form_of, load
from coefficients.signatures import COSINE, REMARKS, arguments, light_cosines, signature
from coefficients.table import Table
from fitting import Form
from integrals import PS, Axis, Integral
from integrals.fuzz.ps import FLOAT32_STEPS, FLOAT64_STEPS, scattered_fraction
from programs.function import Function, Parameter, function

EXACT_PS = "exact/ps"
# The least α whose error in float32 is stated.
LEAST_EXACT_ALPHA = 0.05


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
    functions = signature(form_of(table))
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
        Parameter("NdotU", COSINE),
        Parameter("TdotU", (-1.0, 1.0)),
        Parameter("NdotT", COSINE),
        Parameter("alpha", (LEAST_EXACT_ALPHA, 1.0)),
    )
    return (function(name, parameters, exact, "P_s in closed form, without coefficients."),)


def is_exact(name: str) -> bool:
    """Tell whether a name is meant for a closed form, of which there is one, and no file's path."""
    return name.startswith("exact/") and not (name.endswith(".json") or os.path.isfile(name))


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
            "closed form, root by Newton's steps",
            PS,
            (replace(PS.axes[0], lower=LEAST_EXACT_ALPHA, open_below=False), *PS.axes[1:]),
            exact_ps(precision, **chosen),
            _exact_columns,
            remark="NdotU = u·n, TdotU = u·t, NdotT = n·t, all unit vectors; t and −t are one "
            "fibre: turn t so that NdotT >= 0",
        )
    if is_exact(name):
        raise ValueError(
            f"no closed form is exported as {name!r}: allowed are {EXACT_PS} and tables' names"
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
        functools.partial(arguments, table.quantity),
        form,
        REMARKS[table.quantity],
    )


def _renamed(functions: tuple[Function, ...], name: str) -> tuple[Function, ...]:
    *before, last = functions
    renamed = [
        replace(each, name=f"Calc{name}Coeffs", summary=each.summary.replace(last.name, name))
        for each in before
    ]
    return (*renamed, replace(last, name=name))


def _exact_columns(points: np.ndarray) -> tuple[np.ndarray, ...]:
    return (np.stack([*light_cosines(points), points[:, 0]], axis=1),)
