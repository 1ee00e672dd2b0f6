"""`shadefit evaluate`: one exact value by every leg, and what the tables make of it."""

import functools
import math
from collections.abc import Callable
from typing import Any

import jax

from coefficients.catalogue import PUBLISHED, form_of, load
from fitting import Form
from integrals import INTEGRALS, Estimate, Integral
from shadefit.options import checked
from shadefit.terminal import place, print_json, print_table

MAX_SAMPLES = 1 << 24


def run(
    name: str,
    given: dict[str, float | None],
    extra: list[str],
    samples: int,
    sequence: str,
    seed: int,
    json: bool,
) -> None:
    """Evaluate the integral `name` at the arguments that are given (None: not given).

    Beside the legs stand the published table, the refitted one, and those that `extra` names.
    """
    if name not in INTEGRALS:
        raise ValueError(f"no integral is called {name!r}: allowed are {', '.join(INTEGRALS)}")
    integral = INTEGRALS[name]
    arguments = _checked(integral, given)
    if not 2 <= samples <= MAX_SAMPLES:
        raise ValueError(f"samples = {samples}: allowed are 2 to {MAX_SAMPLES}")
    if not 0 <= seed < 1 << 63:
        raise ValueError(f"seed = {seed}: allowed are 0 to 2⁶³ − 1")
    forms = _forms(name, extra)
    options = (("samples", samples), ("sequence", sequence), ("seed", seed))
    legs = {}
    for leg_name in integral.legs:
        leg = _compiled(name, leg_name, options if leg_name == "monte_carlo" else ())
        estimate = leg(*arguments.values())
        legs[leg_name] = {"value": float(estimate.value), "error": float(estimate.error)}
    exact = legs[integral.reference]["value"]
    if math.isnan(exact):
        raise ValueError(
            f"{integral.symbol} has no limit at {place(arguments)}, and no value: "
            "allowed are all other points of its domain"
        )
    tables = {label: _by_form(form, arguments, exact) for label, form in forms.items()}
    if json:
        print_json({"quantity": name, "arguments": arguments, "legs": legs, "tables": tables})
        return
    print_table(
        f"{integral.symbol} = {integral.definition}",
        ["by", "value", "error"],
        [
            [leg_name.replace("_", " "), f"{leg['value']:.15g}", f"± {leg['error']:.1e}"]
            for leg_name, leg in legs.items()
        ]
        + [
            [label, *_cells(entry)]
            for label, entry in tables.items()
        ],
        "Error: stated by the leg (Monte Carlo: one standard error); of a table, its distance "
        "from the exact value.",
    )  # fmt: skip


@functools.lru_cache(maxsize=16)
def _compiled(name: str, leg: str, options: tuple[tuple[str, Any], ...]) -> Callable[..., Estimate]:
    """Compile a leg whole: operation by operation it would take several times as long."""
    return jax.jit(functools.partial(INTEGRALS[name].legs[leg], **dict(options)))


def _checked(integral: Integral, given: dict[str, float | None]) -> dict[str, float]:
    wanted = [axis.name for axis in integral.axes]
    flags = ", ".join(f"--{name.replace('_', '-')}" for name in wanted)
    for name, value in given.items():
        if (value is None) == (name in wanted):
            problem = "is missing" if value is None else "is no argument"
            flag = name.replace("_", "-")
            raise ValueError(f"--{flag} {problem} of {integral.name}, which takes {flags}")
    values = {axis.name: given[axis.name] for axis in integral.axes}
    return {axis.name: checked(axis, float(values[axis.name] or 0.0)) for axis in integral.axes}


def _forms(name: str, extra: list[str]) -> dict[str, Form]:
    """Give the forms of the tables to show, by label; all have to be of the integral `name`."""
    known = {"published": f"published/{name}"} if name in PUBLISHED else {}
    forms = {label: form_of(load(table)) for label, table in (known | {"refitted": name}).items()}
    for table in extra:
        form = form_of(load(table))
        if form.integral.name != name:
            raise ValueError(
                f"table {table} is of {form.integral.name}: allowed are those of {name}"
            )
        forms[table] = form
    return forms


def _by_form(form: Form, arguments: dict[str, float], exact: float) -> dict:
    outside = [
        f"{axis.name} is outside {axis.domain}"
        for axis in form.axes
        if not axis.contains(arguments[axis.name])
    ]
    if outside:
        return {"value": None, "difference": None, "reason": "; ".join(outside)}
    value = float(form(*arguments.values()))
    return {"value": value, "difference": value - exact, "reason": None}


def _cells(entry: dict) -> list[str]:
    if entry["value"] is None:
        return ["—", entry["reason"]]
    return [f"{entry['value']:.15g}", f"{entry['difference']:+.1e}"]
