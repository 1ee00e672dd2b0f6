"""`shadefit cost`: operations by kind, and evaluations a second, beside the exact form."""

from dataclasses import asdict

from coefficients.shaders import EXACT_PS, exact_ps, shader
from programs.cost import Cost
from programs.functions import Function
from programs.toolchains.throughput import Throughput, throughput
from shadefit.export import KINDS, costs
from shadefit.terminal import print_json, print_table


def run(name: str, measure: bool, json: bool) -> None:
    """Count, and measure if that is asked for, every function that a name is exported as."""
    chosen = shader(name)
    labelled = [(_when(chosen.functions, function), function) for function in chosen.functions]
    if chosen.integral.name == "ps" and chosen.form is not None:
        labelled += [(f"a direction, {EXACT_PS}", function) for function in exact_ps()]
    counted = costs(tuple(function for _, function in labelled))
    rates = {f.name: throughput(f) for _, f in labelled} if measure else {}
    if json:
        record = [
            _record(when, function, counted[function.name], rates.get(function.name))
            for when, function in labelled
        ]
        print_json({"name": name, "functions": record})
        return
    note = "" if chosen.integral.name == "ps" else "No exact form is exported beside it."
    print_table(
        f"{name}: operations",
        ["function", "evaluated for", *KINDS, "fma", "operations", "weighted"],
        [_row(when, function.name, counted[function.name]) for when, function in labelled],
        "select: comparisons, selections, minima, maxima, roundings. sign: negations, absolute "
        "values; not among the operations. fma: additions that could take up a product, counted in "
        f"both. {note}".strip(),
    )
    if rates:
        print_table(
            f"{name}: evaluations a second in float32",
            ["function", "compiled C", "JAX", "ratio", "largest difference"],
            [
                [
                    each,
                    f"{rate.compiled / 1e6:.0f} million",
                    f"{rate.jax / 1e6:.0f} million",
                    f"{rate.ratio:.2f}",
                    f"{rate.difference:.1e}",
                ]
                for each, rate in rates.items()
            ],
            "C: one thread; JAX: as many as it takes. Random points of the domain.",
        )


def _when(functions: tuple[Function, ...], function: Function) -> str:
    if len(functions) == 1:
        return "a point"
    return "a direction" if function is functions[-1] else "a material"


def _row(when: str, name: str, cost: Cost) -> list[str]:
    kinds = [str(getattr(cost, kind)) for kind in (*KINDS, "fma", "operations", "weighted")]
    return [name, when, *kinds]


def _record(when: str, function: Function, cost: Cost, rate: Throughput | None) -> dict:
    return {
        "function": function.name,
        "evaluated_for": when,
        **asdict(cost),
        "operations": cost.operations,
        "weighted": cost.weighted,
        "throughput": None if rate is None else {**asdict(rate), "ratio": rate.ratio},
    }
