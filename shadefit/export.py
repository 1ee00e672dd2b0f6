"""`shadefit export`: a table as JSON, or as shader code headed by what it is worth."""

import shlex
from dataclasses import replace
from pathlib import Path

import numpy as np

from coefficients.catalogue import load
from coefficients.files import require_writable_file, write_whole
from coefficients.proven import proofs
from coefficients.shaders import EXACT_PS, Shader, exact_ps, is_exact, shader
from coefficients.table import serialise
from coefficients.verify import Difference, Problem, precision_of, run_code, text_of
from fitting import off_grid_errors
from fitting.points.scattered import COUNTS
from programs.cost import Cost, count
from programs.functions import Function
from programs.languages import PRECISIONS, target
from programs.printing.printer import write
from programs.toolchains import ToolchainError
from programs.toolchains.registry import toolchain
from programs.tracing.tracer import trace

# Half is good enough where it adds no more to a fit's error than the error itself; the closed form,
# which has none, may lose two bits of the eleven that half has.
WORTH = 2.0
HALF_ALLOWANCE = 4 * float(np.finfo(np.float16).eps)

KINDS = ("add", "mul", "div", "sqrt", "transcendental", "select", "sign")


def run(
    name: str,
    output: Path | None,
    language: str | None,
    precision: str | None,
    function_name: str | None,
    constants: str | None,
) -> None:
    """Write a table's JSON, or its code in a language, to a file, or print it."""
    if output is not None:
        require_writable_file(output)
    if language is None:
        for option, given in (
            ("--precision", precision),
            ("--name", function_name),
            ("--constants", constants),
        ):
            if given is not None:
                raise ValueError(f"{option} {given!r} is for code: allowed with --to LANG")
        if is_exact(name):
            raise ValueError(f"{name} has no coefficients: allowed is {EXACT_PS} with --to LANG")
        text = serialise(load(name))
    else:
        text = code(name, language, precision, function_name, constants or "inline")
    if output is None:
        print(text, end="")
    else:
        write_whole(output, text)


def code(
    name: str,
    language: str,
    precision: str | None = None,
    function_name: str | None = None,
    constants: str = "inline",
) -> str:
    """Give the source file of a table or of 'exact/ps', header and all.

    Arguments: `name`; `language`, a key of TARGETS; `precision`, None for float (JavaScript:
    double); `function_name`, None for the paper's; `constants`, "inline" or "table". Returns the
    source; the same call gives the same bytes on a machine. Raises ValueError as `shader` and
    `write` do.
    """
    kind = precision_of(language, precision)
    chosen = shader(name, kind, function_name)
    # Before anything is measured: what cannot be written is refused at once.
    bare = write(chosen.functions, language, kind, constants=constants)
    command = ["shadefit", "export", name, "--to", language]
    if precision is not None:
        command += ["--precision", precision]
    if function_name is not None:
        command += ["--name", function_name]
    if constants != "inline":
        command += ["--constants", constants]
    head = _header(chosen, name, language, kind, bare, shlex.join(command))
    return write(chosen.functions, language, kind, constants=constants, header=head)


def described(cost: Cost) -> str:
    """Write an operation count as text: '63 operations (23 add, 30 mul, …)'."""
    kinds = [f"{getattr(cost, kind)} {kind}" for kind in KINDS if getattr(cost, kind)]
    fused = f"; {cost.fma} fma possible" if cost.fma else ""
    return f"{cost.operations} operations ({', '.join(kinds)}{fused})"


def costs(functions: tuple[Function, ...]) -> dict[str, Cost]:
    """Count the operations of each function, by its name."""
    return {function.name: count(trace(function)) for function in functions}


def _header(
    chosen: Shader, name: str, language: str, precision: str, source: str, command: str
) -> dict[str, str]:
    problem = Problem(chosen, precision)
    measured, how = _measured(problem, language, source)
    head = {
        "Quantity": f"{chosen.quantity}: {chosen.integral.symbol} = {chosen.integral.definition}",
        "Equation": f"{chosen.equation} of table {name}" if chosen.form else chosen.equation,
        "Domain": f"{_domain(chosen.functions)}; all others without unit",
    }
    if chosen.remark:
        head["Arguments"] = chosen.remark
    known = [] if chosen.form is None else proofs(name)
    if known:
        head["Proven in exact arithmetic"] = "; ".join(known)
    own = None
    if chosen.form is None:
        # The same points and steps, without the precision's roundings.
        left = problem.against_integral(Problem(chosen, "double").form)
        head["Error in exact arithmetic"] = (
            f"none but what the root's steps leave: {text_of(left)} (in float64)"
        )
    else:
        errors = off_grid_errors(chosen.form)
        own = Difference(errors.largest, errors.rms)
        climbs = COUNTS[chosen.integral.name].climbs
        uphill = ", and uphill from the worst" if climbs else ""
        head["Error in exact arithmetic"] = (
            f"{text_of(own)} against the integral (rms over {errors.points} points off the fitting "
            f"grid; largest sought on more, of the boundary and where it is steep{uphill})"
        )
    head[f"Error in {precision}"] = (
        f"{text_of(measured)} against the integral ({len(problem.integral)} fixed points, corners "
        f"of the domain included; {how})"
    )
    if precision == "half":
        head["Half precision"] = _verdict(problem, own, measured)
    head["Cost"] = "; ".join(
        f"{n}: {described(cost)}" for n, cost in costs(chosen.functions).items()
    )
    if chosen.form is not None and chosen.integral.name == "ps":
        (exact,) = costs(exact_ps(precision)).values()
        head["Cost of the closed form"] = f"{described(exact)} ({EXACT_PS})"
    head["Made by"] = command
    return head


def _domain(functions: tuple[Function, ...]) -> str:
    """Give the domains of what the functions are called with, by their arguments' names."""
    parameters = {p.name: p for each in functions for p in each.parameters if p.size is None}
    return ", ".join(
        f"{p.name} in [{p.domain[0]:.6g}, {p.domain[1]:.6g}]{'' if p.unit == '1' else ' ' + p.unit}"
        for p in parameters.values()
    )


def _measured(problem: Problem, language: str, source: str) -> tuple[Difference, str]:
    name = target(language).name
    reason = f"{name} was not run"
    if toolchain(language).missing(problem.precision) is None:
        try:
            values = run_code(problem, language, source)
            return problem.against_integral(values), f"this code run in {name}"
        except ToolchainError as error:
            reason = error.summary
    values = problem.emulated(PRECISIONS[problem.precision])
    return problem.against_integral(values), f"emulated, every operation rounded: {reason}"


def _verdict(problem: Problem, own: Difference | None, measured: Difference) -> str:
    if own is None:
        good = measured.largest <= HALF_ALLOWANCE and not measured.not_finite
        bound = f"largest error {HALF_ALLOWANCE:.1e}"
    else:
        # The fit's own error on the same points, so that only the precision differs.
        own = problem.against_integral(problem.form)
        good = measured.within(replace(own, largest=WORTH * own.largest, rms=WORTH * own.rms))
        bound = f"{WORTH:g} times the fit's own {text_of(own)} on the same points"
    return f"{'good enough' if good else 'NOT GOOD ENOUGH'} (bound: {bound})"
