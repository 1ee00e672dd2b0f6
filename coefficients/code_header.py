"""The comment above the exported code of an entry: what it is, its errors, proofs and cost."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from coefficients.catalogue import EXACT, Entry, resolve
from coefficients.code_equation import code_equation
from coefficients.proof_text import proofs, rounding_text
from fitting import judge
from programs import (
    KINDS,
    PRECISIONS,
    Cost,
    Difference,
    Function,
    ToolchainError,
    Trial,
    count_operations,
    language,
    toolchain,
    trace,
)
from programs.toolchains.difference import difference, text_of
from programs.toolchains.half_precision import verdict
from programs.toolchains.verification import run_code


def costs(functions: Sequence[Function]) -> dict[str, Cost]:
    """Count the operations of each function, by its name."""
    return {each.name: count_operations(trace(each)) for each in functions}


def cost_text(cost: Cost) -> str:
    """Write an operation count as text: '63 operations (23 add, 30 mul, …)'."""
    kinds = [f"{getattr(cost, kind)} {kind}" for kind in KINDS if getattr(cost, kind)]
    fused = f"; {cost.fma} fma possible" if cost.fma else ""
    return f"{cost.operations} operations ({', '.join(kinds)}{fused})"


def header_of(
    entry: Entry, trial: Trial, key: str, source: str | None, command: str
) -> dict[str, str]:
    """Return the labels and texts of the comment above an entry's exported functions.

    Arguments: `trial`, with the functions and the precision; `key`, a key of LANGUAGES; `source`,
    the code that is run to measure its error, None if the file holds no code; `command`, which
    makes the file.
    """
    functions, precision = trial.calls.functions, trial.precision
    reference = entry.problem.reference
    against = reference.compared_with
    meant = f": {reference.symbol} = {reference.definition}" if reference.definition else ""
    head = {
        "Quantity": f"{entry.problem.description}{meant}",
        "Equation": code_equation(entry),
        "Domain": _domain(functions),
    }
    if entry.remark:
        head["Arguments"] = entry.remark
    if entry.fitted is None:
        # This is the same program with the same number of steps, but evaluated in float64.
        left = trial.against_integral(replace(trial, precision="double").form)
        head["Error in exact arithmetic"] = f"{entry.exact_code.left}: {text_of(left)} (in float64)"
    else:
        known = proofs(entry)
        if known:
            head["Proven in exact arithmetic"] = "; ".join(known)
        head["Error in exact arithmetic"] = _own_errors(entry)
    if trial.exact is not None or precision == "half":
        values, how = _values(trial, key, source)
        if trial.exact is not None:
            where = "" if reference.data else ", corners of the domain included"
            head[f"Error in {precision}"] = (
                f"{text_of(trial.against_integral(values))} against {against} "
                f"({trial.integral_points} fixed points{where}; {how})"
            )
        if precision == "half":
            head["Half precision"] = _verdict(trial, values)
        if precision == "float":
            rounding = difference(values, trial.form).largest
            head["Rounding in float"] = rounding_text(entry, rounding, len(values))
    head["Cost"] = "; ".join(f"{n}: {cost_text(cost)}" for n, cost in costs(functions).items())
    beside = closed_form_beside(entry)
    if beside is not None:
        (exact,) = costs(beside.functions(precision)).values()
        head["Cost of the closed form"] = f"{cost_text(exact)} ({beside.name})"
    head["Made by"] = command
    return head


def _own_errors(entry: Entry) -> str:
    """Return a text about the errors of a fitted form in float64."""
    reference, fitted = entry.problem.reference, entry.require_fitted()
    if not (reference.legs or reference.data):
        table = entry.require_table()
        if table.errors is None:
            return "not stated, and not measured: exact values are not known"
        stated = table.errors.off_grid
        of_data = table.reference is not None and table.reference.data is not None
        against = "the data's own points" if of_data else "exact values"
        own = Difference(stated.max, stated.rms)
        return f"{text_of(own)} against {against}, as the table states; not measured again"
    errors = judge(fitted)
    own = Difference(errors.largest, errors.rms)
    if reference.data is not None:
        which = "that no fit used" if reference.data.held_out.any() else "which were fitted too"
        rows = f"{errors.points} rows of {reference.data.source}, {which}"
        return f"{text_of(own)} against {reference.compared_with} ({rows})"
    uphill = ", and uphill from the worst" if reference.sampling.climbs else ""
    return (
        f"{text_of(own)} against {reference.compared_with} (rms over {errors.points} points off "
        f"the fitting grid; largest sought on more, of the boundary and where it is steep{uphill})"
    )


def closed_form_beside(entry: Entry) -> Entry | None:
    """Return the closed form whose cost is stated beside that of a table; None if there is none.

    There is one only for a form of two stages whose quantity has an exported closed form.
    """
    if entry.fitted is None or entry.fitted.form.inputs is None:
        return None
    return resolve(f"{EXACT}/{entry.problem.name}") if entry.problem.exact_code else None


def _domain(functions: Sequence[Function]) -> str:
    """Write the domains of the functions' scalar arguments as text, with their units if any."""
    parameters = {p.name: p for each in functions for p in each.parameters if p.size is None}
    text = ", ".join(
        f"{p.name} in [{p.domain[0]:.6g}, {p.domain[1]:.6g}]{'' if p.unit == '1' else ' ' + p.unit}"
        for p in parameters.values()
    )
    has_units = any(p.unit != "1" for p in parameters.values())
    return f"{text}; all others without unit" if has_units else text


def _values(trial: Trial, key: str, source: str | None) -> tuple[np.ndarray, str]:
    """Return the values (n,) of a trial's code, and a text that says how they were found."""
    name = language(key).name
    reason = f"{name} was not run" if source is not None else "nodes were not run"
    if source is not None and toolchain(key).missing(trial.precision) is None:
        try:
            return run_code(trial, key, source), f"this code run in {name}"
        except ToolchainError as error:
            reason = error.summary
    values = trial.emulated(PRECISIONS[trial.precision])
    return values, f"emulated, every operation rounded: {reason}"


def _verdict(trial: Trial, values: np.ndarray) -> str:
    """Say whether half precision is good enough: the same rule as that of `shadefit verify`."""
    good, said = verdict(trial, difference(values, trial.form))
    return f"{'good enough' if good else 'NOT GOOD ENOUGH'}: {said}"
