"""The exported functions of an entry: their values, verification, costs, and source files."""

import functools
import shlex
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from coefficients.catalogue import EXACT, Entry, resolve
from coefficients.proof_text import proofs
from fitting import judge
from fitting.points.grids import sobol_points
from fitting.points.scattered import data_points
from programs import (
    KINDS,
    PRECISIONS,
    CallSequence,
    Cost,
    Difference,
    Function,
    Program,
    ToolchainError,
    Trial,
    count_operations,
    evaluate,
    language,
    precision_of,
    toolchain,
    trace,
    write_source,
)
from programs.toolchains.verification import corners, run_code, text_of
from quantities.loader import option_for

# Code is run at 2^EXPONENT points and at the corners of the domain.
EXPONENT = 17
SEED = 20200718
# Half precision is called good enough if errors are at most this many times those of the fit in
# float64.
WORTH = 2.0
# The closed form has no such errors. In half precision its error may be this large: it may lose two
# of the eleven bits.
HALF_ALLOWANCE = 4 * float(np.finfo(np.float16).eps)


def trial_of(entry: Entry, precision: str, exponent: int = EXPONENT) -> Trial:
    """Return the trial that verifies an entry's exported code in a precision.

    It has 2^exponent points and the corners of the domain.
    """
    points = [corners(entry.axes), sobol_points(entry.axes, exponent, SEED)]
    reference = entry.problem.reference
    calls = CallSequence(entry.functions(precision), entry.arguments_at)
    if reference.data is not None:
        own, values, _ = data_points(entry.require_fitted().form, reference.data.judging)
        every = np.concatenate([own, *points])
        return Trial(calls, every, precision, lambda some: values[: len(some)], len(own))
    exact = reference.values if reference.legs else None
    return Trial(calls, np.concatenate(points), precision, exact, reference.sampling.verified)


def exported_values(entry: Entry, points: np.ndarray) -> np.ndarray:
    """Return the values (…) of an entry's exported code at points (…, axes), in float64.

    The functions are called one after the other, with their clamps, as a renderer calls them.
    """
    flat = points.reshape(-1, points.shape[-1])
    results = np.empty((len(flat), 0))
    for program, own in zip(programs_of(entry), entry.arguments_at(flat), strict=True):
        results = evaluate(program, np.concatenate([results, own], axis=1))
    return results[:, 0].reshape(points.shape[:-1])


@functools.lru_cache(maxsize=256)
def programs_of(entry: Entry, precision: str = "double") -> tuple[Program, ...]:
    """Return the traced programs of an entry's exported functions, in the order of the calls."""
    return tuple(trace(each) for each in entry.functions(precision))


def operations_of(entry: Entry) -> int:
    """Count the operations of the function that returns the value.

    For a form of two stages this is the second function. The cost of the first is not counted,
    because many points share it.
    """
    return count_operations(trace(entry.functions()[-1])).operations


def costs(functions: Sequence[Function]) -> dict[str, Cost]:
    """Count the operations of each function, by its name."""
    return {each.name: count_operations(trace(each)) for each in functions}


def cost_text(cost: Cost) -> str:
    """Write an operation count as text: '63 operations (23 add, 30 mul, …)'."""
    kinds = [f"{getattr(cost, kind)} {kind}" for kind in KINDS if getattr(cost, kind)]
    fused = f"; {cost.fma} fma possible" if cost.fma else ""
    return f"{cost.operations} operations ({', '.join(kinds)}{fused})"


def source_file(
    entry: Entry,
    key: str,
    precision: str | None = None,
    function_name: str | None = None,
    constants: str = "inline",
    made_by: str | None = None,
) -> str:
    """Return the source file of an entry; its header states domain, errors, proofs and cost.

    Arguments: `key`, a key of LANGUAGES; `precision`, None for float (JavaScript: double);
    `function_name`, None for the quantity's own; `constants`, "inline" or "table"; `made_by`, a
    text for the header in place of the command line. On one machine, the same call returns the
    same bytes. Raises ValueError for what cannot be written.
    """
    kind = precision_of(key, precision)
    functions = entry.functions(kind, function_name)
    # The source is first written without its header: if that is not possible, no time is spent on
    # measurements.
    bare = write_source(functions, key, kind, constants=constants)
    command = ["shadefit", "export", *option_for(entry.problem), entry.name, "--to", key]
    if precision is not None:
        command += ["--precision", precision]
    if function_name is not None:
        command += ["--name", function_name]
    if constants != "inline":
        command += ["--constants", constants]
    trial = trial_of(entry, kind)
    trial = replace(trial, calls=replace(trial.calls, functions=functions))
    head = _header(entry, trial, key, bare, made_by or shlex.join(command))
    return write_source(functions, key, kind, constants=constants, header=head)


def _header(entry: Entry, trial: Trial, key: str, source: str, command: str) -> dict[str, str]:
    functions, precision = trial.calls.functions, trial.precision
    reference = entry.problem.reference
    equation = entry.equation
    against = reference.compared_with
    meant = f": {reference.symbol} = {reference.definition}" if reference.definition else ""
    head = {
        "Quantity": f"{entry.problem.description}{meant}",
        "Equation": f"{equation} of table {entry.name}" if entry.fitted else equation,
        "Domain": f"{_domain(functions)}; all others without unit",
    }
    if entry.remark:
        head["Arguments"] = entry.remark
    own = None
    if entry.fitted is None:
        # This is the same program with the same number of steps, but evaluated in float64.
        left = trial.against_integral(replace(trial, precision="double").form)
        head["Error in exact arithmetic"] = f"{entry.exact_code.left}: {text_of(left)} (in float64)"
    else:
        known = proofs(entry)
        if known:
            head["Proven in exact arithmetic"] = "; ".join(known)
        own, head["Error in exact arithmetic"] = _own_errors(entry)
    if trial.exact is not None:
        measured, how = _measured(trial, key, source)
        where = "" if reference.data else ", corners of the domain included"
        head[f"Error in {precision}"] = (
            f"{text_of(measured)} against {against} ({len(trial.integral)} fixed points{where}; "
            f"{how})"
        )
        if precision == "half":
            head["Half precision"] = _verdict(trial, own, measured)
    head["Cost"] = "; ".join(f"{n}: {cost_text(cost)}" for n, cost in costs(functions).items())
    beside = closed_form_beside(entry)
    if beside is not None:
        (exact,) = costs(beside.functions(precision)).values()
        head["Cost of the closed form"] = f"{cost_text(exact)} ({beside.name})"
    head["Made by"] = command
    return head


def _own_errors(entry: Entry) -> tuple[Difference, str]:
    """Return the errors of a fitted form in float64, and a text for the header."""
    reference, fitted = entry.problem.reference, entry.require_fitted()
    if not (reference.legs or reference.data):
        stated = entry.require_table().errors
        if stated is None:
            return Difference(np.nan, np.nan), "not stated, and not measured: exact values unknown"
        own = Difference(stated.off_grid.max, stated.off_grid.rms)
        return own, f"{text_of(own)}, as the table states; not measured again"
    errors = judge(fitted)
    own = Difference(errors.largest, errors.rms)
    if reference.data is not None:
        which = "that no fit used" if reference.data.held_out.any() else "which were fitted too"
        rows = f"{errors.points} rows of {reference.data.source}, {which}"
        return own, f"{text_of(own)} against {reference.compared_with} ({rows})"
    uphill = ", and uphill from the worst" if reference.sampling.climbs else ""
    return own, (
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
    """Write the domains of the functions' scalar arguments as text."""
    parameters = {p.name: p for each in functions for p in each.parameters if p.size is None}
    return ", ".join(
        f"{p.name} in [{p.domain[0]:.6g}, {p.domain[1]:.6g}]{'' if p.unit == '1' else ' ' + p.unit}"
        for p in parameters.values()
    )


def _measured(trial: Trial, key: str, source: str) -> tuple[Difference, str]:
    name = language(key).name
    reason = f"{name} was not run"
    if toolchain(key).missing(trial.precision) is None:
        try:
            values = run_code(trial, key, source)
            return trial.against_integral(values), f"this code run in {name}"
        except ToolchainError as error:
            reason = error.summary
    values = trial.emulated(PRECISIONS[trial.precision])
    return trial.against_integral(values), f"emulated, every operation rounded: {reason}"


def _verdict(trial: Trial, own: Difference | None, measured: Difference) -> str:
    if own is None:
        good = measured.largest <= HALF_ALLOWANCE and not measured.not_finite
        bound = f"largest error {HALF_ALLOWANCE:.1e}"
    else:
        # The fit's error is measured at the same points, so that only the precision differs.
        own = trial.against_integral(trial.form)
        good = measured.within(replace(own, largest=WORTH * own.largest, rms=WORTH * own.rms))
        bound = f"{WORTH:g} times the fit's own {text_of(own)} on the same points"
    return f"{'good enough' if good else 'NOT GOOD ENOUGH'} (bound: {bound})"
