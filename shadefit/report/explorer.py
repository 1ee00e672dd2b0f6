"""The explorer's half in Python: exported JavaScript, and what the page has to know about it.

Everything that the page evaluates is printed from the functions that are fitted and integrated
here: P_s, G and Q in closed form, and every named table. R is the same product rule as
`integrals.fuzz.r` over the exported P_s.
"""

import json
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

import numpy as np
from matplotlib import colormaps

from coefficients.catalogue import form_of, load
from integrals import INTEGRALS, Axis
from integrals.fuzz.g import ambient_scattering
from integrals.fuzz.ps import fraction_at
from integrals.fuzz.q import average_penetration
from integrals.rules.interval import gauss_legendre
from programs.functions import Function, Parameter, function
from programs.printing.printer import write
from shadefit.figures.style import ERRORS, VALUES
from shadefit.figures.values import kind_of, quantities, tables_of

SCRIPTS = ("explorer_model.js", "explorer_draw.js", "explorer.js")
# R by the page's rule of so many nodes an angle: its error is in tests/test_explorer.py.
NODES = 48
_COLOURS = 33


@dataclass(frozen=True)
class _Slider:
    """How far an argument is explored, in its own unit, and where it begins."""

    lower: float
    upper: float
    start: float


_SLIDERS = {
    "alpha": _Slider(0.05, 1.0, 0.35),
    "theta_f": _Slider(0.0, np.pi / 2, np.pi / 4),
    "theta_u": _Slider(0.0, np.pi / 2, np.pi / 6),
    "phi": _Slider(-np.pi, np.pi, np.pi / 2),
    "density": _Slider(0.001, 1.0, 0.2),
    "cos_v": _Slider(0.001, 1.0, 0.5),
}
_EXACT: dict[str, Callable] = {
    "ps": fraction_at,
    "g": ambient_scattering,
    "q": average_penetration,
}


def functions() -> dict[str, Function]:
    """Give every function that the page calls, by the name it has there."""
    exact = [_exact(quantity) for quantity in _EXACT]
    tables = [_of_table(name) for quantity in quantities() for name in tables_of(quantity)]
    return {each.name: each for each in (*exact, *tables)}


@cache
def exported() -> str:
    """Give the JavaScript of every function, as the printer writes it."""
    return write(list(functions().values()), "javascript", "double")


def script() -> str:
    """Give the page's whole script: exported functions, what is known of them, and the explorer."""
    known = json.dumps(_known(), ensure_ascii=False, allow_nan=False)
    own = [files("shadefit.report").joinpath(name).read_text(encoding="utf-8") for name in SCRIPTS]
    names = ", ".join(functions())
    given = f"const exported = {{ {names} }};\nconst known = {known};"
    parts = ['"use strict";', "(() => {", exported(), given, *own, "})();"]
    # In a script element, nothing may look like its end.
    return "\n".join(parts).replace("</", "<\\/")


def identifier(table: str) -> str:
    """Make a table's name one of JavaScript: 'published/ps@printed' becomes publishedPsPrinted."""
    kind = kind_of(table)
    words = "".join(c if c.isalnum() else " " for c in table.rpartition("/")[2]).split()
    first = "published" if kind == "printed" else kind
    return first + "".join(word[:1].upper() + word[1:] for word in words)


def _exact(quantity: str) -> Function:
    integral = INTEGRALS[quantity]
    parameters = [_parameter(axis, _SLIDERS[axis.name]) for axis in integral.axes]
    summary = f"{integral.symbol} in closed form."
    return function(f"exact{quantity.capitalize()}", parameters, _EXACT[quantity], summary)


def _of_table(name: str) -> Function:
    table = load(name)
    form = form_of(table)
    parameters = [_parameter(axis, axis) for axis in form.axes]
    summary = f"{form.integral.symbol} by {table.equation} of table {name}."
    return function(identifier(name), parameters, form.__call__, summary)


def _parameter(axis: Axis, limits: Axis | _Slider) -> Parameter:
    # As far as is explored: of an axis without end, a table may be made for all of it.
    upper = min(limits.upper, max(_SLIDERS[axis.name].upper, limits.lower))
    return Parameter(axis.name, (float(limits.lower), float(upper)), axis.unit)


def _known() -> dict:
    rule = gauss_legendre(NODES, 0.0, 1.0)
    return {
        "quantities": [_quantity(name) for name in quantities()],
        "sliders": {
            name: {"low": slider.lower, "high": slider.upper, "start": slider.start}
            for name, slider in _SLIDERS.items()
        },
        "rule": {"cosines": rule[0].tolist(), "weights": rule[1].tolist()},
        "colours": {"values": _ramp(VALUES), "errors": _ramp(ERRORS)},
    }


def _quantity(name: str) -> dict:
    integral = INTEGRALS[name]
    return {
        "name": name,
        "symbol": integral.symbol.replace("_s", "ₛ"),
        "axes": [
            {"name": axis.name, "symbol": axis.symbol, "unit": axis.unit, "meaning": axis.meaning}
            for axis in integral.axes
        ],
        "tables": [_table(each) for each in tables_of(name)],
    }


def _table(name: str) -> dict:
    form = form_of(load(name))
    kind = kind_of(name)
    return {
        "name": name,
        "kind": kind,
        "function": identifier(name),
        "domain": [[float(axis.lower), min(float(axis.upper), 1e9)] for axis in form.axes],
        "shown": kind in ("published", "refitted"),
    }


def _ramp(name: str) -> list[list[int]]:
    colours = colormaps[name](np.linspace(0, 1, _COLOURS))[:, :3]
    return np.round(255 * colours).astype(int).tolist()
