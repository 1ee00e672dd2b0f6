"""Where tables come from: fits, the folder of published constants, the folder of refits, files."""

import json
import os
import platform
import reprlib
from dataclasses import asdict
from importlib.metadata import version
from pathlib import Path
from typing import Any

import jax.numpy as jnp
import numpy as np

from coefficients.table import SCHEMA, Table, parse, read
from fitting import PAPER_FORMS, Fit, Form
from fitting.families import FAMILIES, form_class
from fitting.goal import LEAST_SQUARES
from fitting.points.sample import Sample
from fitting.velvet import ConservativeNorm
from integrals import INTEGRALS

FOLDER = Path(__file__).parent
QUANTITIES = tuple(INTEGRALS)
# Those that the paper has a table of.
PUBLISHED = ("ps", "g", "q", "r")
# Forms that are no family's: the paper's, and r(k)'s.
SINGLE_FORMS = {**PAPER_FORMS, ConservativeNorm.name: ConservativeNorm}
# A published table with this behind its name is taken as printed, its errata left in.
AS_PRINTED = "@printed"
_STEMS = {*(f"refit/{q}" for q in QUANTITIES), *(f"published/{q}" for q in PUBLISHED)}
# A domain that has been through float32, or was written with seven digits, is the same.
ROUNDING = 1e-6
_LIBRARIES = ("jax", "jaxlib", "lineax", "numpy", "optimistix", "shadefit")


def names() -> list[str]:
    """List the names that `load` knows, published tables last."""
    refitted = [path.stem for path in sorted((FOLDER / "refit").glob("*.json"))]
    best = names_of_best()
    published = [f"published/{name}" for name in sorted(PUBLISHED)]
    printed = [
        name + AS_PRINTED for name in published if load(name) != load(name + AS_PRINTED)
    ]  # fmt: skip
    return [*refitted, *best, *published, *printed]


def names_of_best() -> list[str]:
    """List the tables of forms that are not the paper's: 'best/q-8', …."""
    return [f"best/{path.stem}" for path in sorted((FOLDER / "best").glob("*.json"))]


def load(name: str) -> Table:
    """Read a table by name ('ps', 'published/ps', 'published/ps@printed') or by a file's path.

    A published table is corrected by its errata unless '@printed' follows its name. Raises
    ValueError for a name that is neither, and for a file that is no valid table.
    """
    if is_known(name):
        table = read(FOLDER / f"{_stem(name)}.json")
        return table if name.endswith(AS_PRINTED) else corrected(table)
    # os.path, unlike Path, takes a name that is too long for one that does not exist.
    if name.endswith(".json") or os.path.isfile(name):
        table = corrected(read(Path(name)))
        # Whatever it is for: what it says of its form is true.
        form_of(table)
        return table
    allowed = ", ".join((*QUANTITIES, *(f"published/{q}" for q in PUBLISHED), *names_of_best()))
    raise ValueError(f"no table is called {name!r}: allowed are {allowed}, or a .json file's path")


def is_known(name: str) -> bool:
    """Tell whether a name is one of the tables that are kept here, and no file's path."""
    stem = _stem(name)
    if name.endswith(AS_PRINTED):
        return stem.startswith("published/") and stem in _STEMS
    return stem in _STEMS or stem in names_of_best()


def _stem(name: str) -> str:
    """Give the path of a name's file in FOLDER, without its ending."""
    stem = name.removesuffix(AS_PRINTED)
    return stem if "/" in stem else f"refit/{stem}"


def corrected(table: Table) -> Table:
    """Apply the errata that a published table records; others are returned as they are.

    What is applied is not left to be applied again, when the table is written and read.
    """
    if table.publication is None:
        return table
    rows = list(range(len(table.coefficients)))
    for erratum in table.publication.errata:
        if erratum.exchange_rows is not None:
            first, second = erratum.exchange_rows
            if not (0 <= first < len(rows) and 0 <= second < len(rows)):
                raise ValueError(f"erratum {erratum.id} exchanges rows that do not exist")
            rows[first], rows[second] = rows[second], rows[first]
    applied = [each.model_copy(update={"exchange_rows": None}) for each in table.publication.errata]
    return table.model_copy(
        update={
            "coefficients": [table.coefficients[row] for row in rows],
            "publication": table.publication.model_copy(update={"errata": applied}),
        }
    )


def form_of(table: Table) -> Form:
    """Give the form that a table holds the coefficients of.

    Raises ValueError for a form that is not known, one of another quantity, coefficients that are
    not in its shape, and arguments and names of coefficients that are not the form's.
    """
    if table.shape is None and table.form in SINGLE_FORMS:
        form = SINGLE_FORMS[table.form]
    elif table.shape is None and table.form not in FAMILIES:
        allowed = ", ".join((*SINGLE_FORMS, *FAMILIES))
        raise ValueError(f"form {table.form!r} of {table.name} is not known: allowed are {allowed}")
    else:
        form = form_class(table.form, table.shape or {})
    if form.integral.name != table.quantity:
        raise ValueError(
            f"form {table.form!r} is one of {form.integral.name}, not {table.quantity}"
        )
    expected = np.shape(form.coefficient_names())
    coefficients = np.array(table.coefficients)
    if coefficients.shape != expected:
        raise ValueError(
            f"{table.name} has coefficients of shape {coefficients.shape}, "
            f"form {table.form!r} takes {expected}"
        )
    _require_agreement(table, form)
    return form(jnp.asarray(coefficients))


def _require_agreement(table: Table, form: type[Form]) -> None:
    """Raise ValueError where a table says of its form what the form does not."""
    given = {each.name: (each.unit, each.domain) for each in table.arguments}
    wanted = {axis.name: (axis.unit, [axis.lower, axis.upper]) for axis in form.axes}
    if [each.name for each in table.arguments] != list(wanted):
        raise _contradiction(table, "arguments", list(given), list(wanted))
    for name, (unit, domain) in wanted.items():
        its_unit, its_domain = given[name]
        if its_unit != unit:
            raise _contradiction(table, f"the unit of {name}", its_unit, unit)
        if not np.allclose(its_domain, domain, ROUNDING, ROUNDING):
            raise _contradiction(table, f"the domain of {name}", its_domain, domain)
    names = np.ravel(np.array(table.coefficient_names, dtype=object))
    expected = np.ravel(np.array(form.coefficient_names(), dtype=object))
    for index, (its_name, name) in enumerate(zip(names, expected, strict=True)):
        if its_name != name:
            raise _contradiction(table, f"the name of coefficient {index}", its_name, name)


def _contradiction(table: Table, what: str, given: Any, wanted: Any) -> ValueError:
    # What a file holds may be long: it is shown in part.
    return ValueError(
        f"{table.name} gives {what} as {reprlib.repr(given)}, "
        f"form {table.form!r} has {reprlib.repr(wanted)}"
    )


def from_fit(fit: Fit, command: str, name: str | None = None) -> Table:
    """Write down a fit as a table, by the quantity's name or another; `command` is what made it."""
    form = type(fit.form)
    record = {
        "schema": SCHEMA,
        "name": name or form.integral.name,
        "quantity": form.integral.name,
        "form": form.name,
        **({"shape": form.shape} if form.shape is not None else {}),
        "equation": form.equation,
        "arguments": [_argument(axis) for axis in form.axes],
        "coefficients": np.asarray(fit.form.coefficients).tolist(),
        "coefficient_names": form.coefficient_names(),
        "grid": _grid(fit),
        "weight": fit.weight,
        **({"goal": asdict(fit.goal)} if fit.goal != LEAST_SQUARES else {}),
        "reference": {"leg": form.integral.reference, "error": fit.reference_error},
        "errors": {"on_grid": _errors(fit.on_grid), "off_grid": _errors(fit.off_grid)},
        "certificates": {
            "denominator_bound": _finite(fit.certificate.bound),
            "boxes": fit.certificate.boxes,
            **_known("range", fit.range and [fit.range.lower, fit.range.upper]),
            **_known("least_error", fit.lower_bound),
            **_known("conservative_bound", fit.conservative_bound),
        },
        "provenance": {
            "command": command,
            "versions": {
                "python": platform.python_version(),
                **{library: version(library) for library in _LIBRARIES},
            },
            "solver": fit.solver,
        },
    }
    return parse(json.dumps(record), f"the fit of {form.integral.name}")


def _grid(fit: Fit) -> dict:
    if isinstance(fit.grid, Sample):
        return {"nodes": [], "directions": 0, "points": len(fit.grid.points)}
    nodes = [
        {"argument": axis.name, "count": len(nodes), "spacing": fit.grid.spacing}
        for axis, nodes in zip(fit.grid.axes, fit.grid.nodes, strict=True)
    ]
    return {"nodes": nodes, "directions": fit.directions}


def _argument(axis) -> dict:
    return {"name": axis.name, "unit": axis.unit, "domain": [float(axis.lower), float(axis.upper)]}


def _errors(errors) -> dict:
    return {
        "rms": errors.rms,
        "max": errors.largest,
        "where": errors.where,
        "points": errors.points,
    }


def _known(name: str, value: Any) -> dict:
    return {} if value is None else {name: value}


def _finite(bound: float) -> float | None:
    return bound if np.isfinite(bound) else None
