"""The explorer's part in Python: JavaScript functions, and the data that the page needs about them.

The page evaluates closed forms and tables by JavaScript that is printed from the traced functions.
A table is evaluated by its exported functions, with the clamps, as in a renderer.
"""

import json
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from importlib.resources import files

import numpy as np
from matplotlib import colormaps

from coefficients.catalogue import Entry, entries
from programs import Function, Parameter, function, language, write_source
from quantities import Problem, problems
from quantities.plot_hints import HemisphereHint
from quantities.problem import Average
from shadefit.figures.style import ERRORS, VALUES
from shadefit.figures.values import axis_hints, hints_of
from shadefit.report.code import LISTED, codes

# The first ones need no page.
MODEL = ("explorer_model.js", "explorer_scales.js", "explorer_address.js")
SCRIPTS = (
    *MODEL,
    *("explorer_draw.js", "explorer_pictures.js", "explorer_code.js", "explorer.js"),
)
_COLOURS = 33
# JSON has no infinity: an end of a domain beyond this is no end.
_LARGEST = 1e9
_SUBSCRIPTS = dict(zip("aehijklmnoprstuvx0123456789", "ₐₑₕᵢⱼₖₗₘₙₒₚᵣₛₜᵤᵥₓ₀₁₂₃₄₅₆₇₈₉", strict=True))
# So many of the best tables of a quantity are drawn before the reader chooses others.
_BEST_SHOWN = 3


@dataclass
class _Printed:
    """The functions that the page calls, by name."""

    functions: dict[str, Function] = field(default_factory=dict)

    def add(self, *given: Function) -> str:
        """Add functions, and return the name of the last one."""
        self.functions |= {each.name: each for each in given}
        return given[-1].name

    def unused(self, name: str) -> str:
        """Return a name that no function has: this one, or it with a number at its end."""
        tried = (name, *(f"{name}_{count}" for count in range(2, len(self.functions) + 3)))
        return next(each for each in tried if each not in self.functions)


def explored(more: Sequence[Entry] = ()) -> list[Problem]:
    """List the quantities that the page can evaluate: by a closed form, a rule, or tables.

    `more` are tables that are not packaged. A user's own quantities come first.
    """
    return [
        owner
        for owner in sorted(problems().values(), key=lambda owner: owner.topic != "")
        if owner.closed_form or owner.average or _tables(owner, more)
    ]


def script(more: Sequence[Entry] = ()) -> str:
    """Return the page's whole script: printed functions, the data about them, and the explorer."""
    owners = explored(more)
    functions, known = functions_and_data(owners, more)
    texts = {owner.name: codes(owner, _tables(owner, more)) for owner in owners}
    given = [
        f"const exported = {{ {', '.join(functions)} }};",
        f"const known = {json.dumps(known, ensure_ascii=False, allow_nan=False)};",
        f"const codes = {json.dumps(texts, ensure_ascii=False)};",
    ]
    own = [files("shadefit.report").joinpath(name).read_text(encoding="utf-8") for name in SCRIPTS]
    parts = ['"use strict";', "(() => {", printed(functions), *given, *own, "})();"]
    # HTML ends a script at the first "</script", even within a string, and "<!--" hides that end.
    return re.sub(r"<(?=/|!--)", r"<\\", "\n".join(parts))


def printed(functions: dict[str, Function]) -> str:
    """Return the JavaScript of functions, as the printer writes it."""
    return write_source(list(functions.values()), "javascript", "double")


def functions_and_data(
    owners: Sequence[Problem], more: Sequence[Entry] = ()
) -> tuple[dict[str, Function], dict]:
    """Return the functions that the page calls, by name, and what it knows about quantities."""
    page = _Printed()
    known = {
        "quantities": [_quantity(page, owner, _tables(owner, more)) for owner in owners],
        "languages": [{"key": key, "name": language(key).name} for key in LISTED],
        "colours": {"values": _ramp(VALUES), "errors": _ramp(ERRORS)},
    }
    return page.functions, known


def identifier(entry: Entry) -> str:
    """Return a table's name in JavaScript: 'published/ps@printed' becomes publishedPsPrinted.

    Two tables in files may have names that differ only in what is left out here.
    """
    first = "published" if entry.kind == "printed" else entry.kind
    return first + _camel_case(entry.name.rpartition("/")[2])


def _tables(owner: Problem, more: Sequence[Entry]) -> list[Entry]:
    return [*entries(owner), *(entry for entry in more if entry.problem is owner)]


def _quantity(page: _Printed, owner: Problem, own: list[Entry]) -> dict:
    """Return the data of a quantity, and add the functions that it is evaluated by."""
    hints = hints_of(owner)
    drawn = drawn_at_first(own)
    return {
        "name": owner.name,
        "symbol": _with_subscript(owner.symbol),
        "about": owner.reference.meaning,
        "axes": [
            {
                "name": axis.name,
                "symbol": axis.symbol,
                "meaning": axis.meaning,
                "low": hint.slider[0],
                "high": hint.slider[1],
                "start": hint.start,
                "factor": hint.factor,
                "unit": hint.unit,
                "logarithmic": hint.logarithmic and hint.slider[0] > 0,
            }
            for axis, hint in axis_hints(owner)
        ],
        "against": hints.against or owner.axes[-1].name,
        "exact": page.add(_exact(owner)) if owner.closed_form else None,
        "average": _average(page, owner.average),
        "hemisphere": _hemisphere(hints.hemisphere),
        "tables": [_table(page, entry) | {"shown": entry in drawn} for entry in own],
        "code": min(drawn, key=_stated).name if drawn else None,
    }


def drawn_at_first(own: list[Entry]) -> list[Entry]:
    """Return the tables that are drawn before the reader chooses others.

    They are the published table, those in files, and of the best tables those with the smallest, a
    middle, and the largest error. Without best tables the refitted one is drawn too.
    """
    best = sorted((entry for entry in own if entry.kind == "best"), key=_stated)
    kinds = ("published", "file") if best else ("published", "refitted", "file")
    places = np.linspace(0, len(best) - 1, min(_BEST_SHOWN, len(best))).round().astype(int)
    chosen = [best[place] for place in places]
    return [entry for entry in own if entry.kind in kinds or entry in chosen]


def _stated(entry: Entry) -> tuple[float, str]:
    errors = entry.require_table().errors
    return (math.inf if errors is None else errors.off_grid.max, entry.name)


def _table(page: _Printed, entry: Entry) -> dict:
    """Return the data of a table, and add its exported functions.

    The first function is called with the values of the axes whose places are `order`. A second one
    is called with the results of the first and with those of the function `inputs`.
    """
    name, form = page.unused(identifier(entry)), entry.require_fitted().form
    exported = entry.functions("double", name)
    page.add(*exported)
    axes = [axis.name for axis in form.axes]
    return {
        "name": entry.name,
        "kind": entry.kind,
        "functions": [each.name for each in exported],
        "order": [axes.index(argument.axis) for argument in entry.problem.calling.arguments],
        "inputs": None if form.inputs is None else page.add(_inputs(entry)),
        "domain": [
            [max(float(axis.lower), -_LARGEST), min(float(axis.upper), _LARGEST)]
            for axis in form.axes
        ],
    }


def _inputs(entry: Entry) -> Function:
    """Return the function from all axes' values to a second function's own arguments.

    The tables of a quantity share it, because they share its calling convention.
    """
    owner, inputs = entry.problem, entry.require_fitted().form.inputs
    assert inputs is not None
    symbols = ", ".join(name for name, _ in owner.calling.second)
    return function(
        f"inputs{_camel_case(owner.name)}",
        _parameters(owner),
        lambda *point: tuple(inputs(*point)),
        f"The arguments {symbols} of the functions of {owner.symbol}.",
        len(owner.calling.second),
        "inputs",
    )


def _exact(owner: Problem) -> Function:
    name, summary = f"exact{_camel_case(owner.name)}", f"{owner.symbol} in closed form."
    assert owner.closed_form is not None
    return function(name, _parameters(owner), owner.closed_form, summary)


def _parameters(owner: Problem) -> list[Parameter]:
    return [
        Parameter(axis.name, (float(hint.slider[0]), float(hint.slider[1])), axis.unit)
        for axis, hint in axis_hints(owner)
    ]


def _average(page: _Printed, hint: Average | None) -> dict | None:
    if hint is None:
        return None
    rules = [{"nodes": nodes.tolist(), "weights": w.tolist()} for nodes, w in hint.rules]
    return {"integrand": page.add(_exact(hint.integrand)), "rules": rules}


def _hemisphere(hint: HemisphereHint | None) -> dict | None:
    if hint is None:
        return None
    return {"polar": hint.polar, "azimuth": hint.azimuth, "caption": hint.caption}


def _camel_case(name: str) -> str:
    words = "".join(c if c.isalnum() else " " for c in name).split()
    return "".join(word[:1].upper() + word[1:] for word in words)


def _with_subscript(symbol: str) -> str:
    """Write what follows '_' as a subscript, P_s as Pₛ, if Unicode has its letters."""
    base, _, below = symbol.partition("_")
    if not all(letter in _SUBSCRIPTS for letter in below):
        return symbol
    return base + "".join(_SUBSCRIPTS[letter] for letter in below)


def _ramp(name: str) -> list[list[int]]:
    """Return colours of a map, as red, green and blue from 0 to 255."""
    colours = colormaps[name](np.linspace(0, 1, _COLOURS))[:, :3]
    return np.round(255 * colours).astype(int).tolist()
