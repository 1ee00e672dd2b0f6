"""From a fit, or from published constants, to a table."""

import json
import platform
from dataclasses import asdict
from importlib.metadata import version
from typing import Any

import numpy as np

from coefficients.expression import expression_of
from coefficients.table import SCHEMA, Table, parse
from fitting import Errors, Fit, Form
from fitting.goal import LEAST_SQUARES
from fitting.points.sample import Sample
from fitting.uncertainty import uncertainty
from integrals.reference import Axis, Reference
from quantities.problem import Problem, Published

_LIBRARIES = ("jax", "jaxlib", "lineax", "numpy", "optimistix", "shadefit")


def table_of(
    fit: Fit, command: str, name: str | None = None, owner: Problem | None = None
) -> Table:
    """Return the table of a fit.

    `command` is the command line that made it. `name` is the table's name; None stands for the name
    of the quantity. `owner` is the quantity if a user declared it: the table then says what is
    known of it.
    """
    form = fit.fitted.form
    record = {
        **_form_record(form, name or form.reference.name),
        "coefficients": fit.fitted.constants.tolist(),
        "coefficient_names": form.coefficient_names,
        "expression": expression_of(form).model_dump(),
        **_known("about", None if owner is None or owner.topic else _about(owner)),
        "grid": _grid(fit),
        "weight": fit.measure,
        **({"goal": asdict(fit.goal)} if fit.goal != LEAST_SQUARES else {}),
        "reference": _reference(form.reference, fit.reference_error),
        "errors": {"on_grid": _errors(fit.on_grid), "off_grid": _errors(fit.off_grid)},
        "certificates": {
            "denominator_bound": _finite(fit.certificate.bound),
            "boxes": fit.certificate.boxes,
            **_known("range", fit.range and [fit.range.lower, fit.range.upper]),
            **_known("least_error", fit.least_error),
            **_known("local_optimality", fit.local_optimality and asdict(fit.local_optimality)),
            **_known("conservative_bound", fit.below),
        },
        **_known("uncertainty", None if owner is None or owner.topic else _uncertainty(fit)),
        "provenance": {
            "command": command,
            "versions": {
                "python": platform.python_version(),
                **{library: version(library) for library in _LIBRARIES},
            },
            "solver": fit.solver,
        },
    }
    return parse(json.dumps(record), f"the fit of {form.reference.name}")


def published_table(owner: Problem, constants: Published) -> Table:
    """Return the table of a user's published constants."""
    form = owner.find_form(constants.form)
    record = {
        **_form_record(form, owner.name),
        "coefficients": np.asarray(constants.coefficients, float).tolist(),
        "coefficient_names": form.coefficient_names,
        "expression": expression_of(form).model_dump(),
        **_known("about", None if owner.topic else _about(owner)),
        "publication": {
            "source": constants.source,
            "appendix": "",
            "listing": "",
            "clamps": {},
            "errata": [],
        },
    }
    return parse(json.dumps(record), f"the published constants of {owner.name}")


def _about(owner: Problem) -> dict[str, Any]:
    reference, calling = owner.reference, owner.calling
    finite = all(map(np.isfinite, reference.codomain))
    return {
        "symbol": reference.symbol,
        "definition": reference.definition,
        "meaning": reference.meaning,
        "function": calling.name,
        "arguments": {each.axis: each.name for each in calling.arguments},
        **_known("codomain", list(reference.codomain) if finite else None),
    }


def _uncertainty(fit: Fit) -> dict[str, Any] | None:
    """Return how well the points determine the coefficients; None if they are too few to tell."""
    if not isinstance(fit.grid, Sample):
        return None
    try:
        found = uncertainty(fit.fitted, fit.grid)
    except ValueError:
        return None
    errors = found.standard_errors.tolist() if fit.goal == LEAST_SQUARES and found.unique else None
    return {
        **_known("standard_errors", errors),
        **_known("condition", _finite(found.condition)),
        "unique": found.unique,
        "undetermined": list(found.undetermined),
    }


def _reference(reference: Reference, error: float) -> dict[str, Any]:
    data = reference.data
    if data is None:
        return {"leg": reference.best_leg, "error": error}
    file = {
        "name": data.source,
        "sha256": data.digest,
        "rows": len(data.values),
        "held_out": int(data.held_out.sum()),
    }
    return {"leg": "data", "error": error, "data": file}


def _form_record(form: Form, name: str) -> dict[str, Any]:
    return {
        "schema": SCHEMA,
        "name": name,
        "quantity": form.reference.name,
        "form": form.name,
        **({"shape": form.shape} if form.shape is not None else {}),
        "equation": form.equation,
        "arguments": [_argument(axis) for axis in form.axes],
    }


def _grid(fit: Fit) -> dict:
    if isinstance(fit.grid, Sample):
        return {"nodes": [], "directions": 0, "points": len(fit.grid.points)}
    nodes = [
        {"argument": axis.name, "count": len(nodes), "spacing": fit.grid.spacing}
        for axis, nodes in zip(fit.grid.axes, fit.grid.nodes, strict=True)
    ]
    return {"nodes": nodes, "directions": fit.inner}


def _argument(axis: Axis) -> dict:
    symbol = {} if axis.symbol == axis.name else {"symbol": axis.symbol}
    domain = [float(axis.lower), float(axis.upper)]
    return {"name": axis.name, **symbol, "unit": axis.unit, "domain": domain}


def _errors(errors: Errors) -> dict:
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
