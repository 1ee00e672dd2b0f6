"""`shadefit cost`: count operations by kind, and measure evaluations per second."""

from typing import TYPE_CHECKING, Annotated

import typer

from shadefit.commands.names import require_tables
from shadefit.commands.options import Json
from shadefit.completion import complete_shader

if TYPE_CHECKING:
    from collections.abc import Sequence

    from programs import Cost, Function, Throughput
    from shadefit.code_records import FunctionRecord, ThroughputRecord


def cost(
    table: Annotated[
        str,
        typer.Argument(
            help="A table's name or path, or the name of a function, such as exact/ps or "
            "detail/overlay.",
            autocompletion=complete_shader,
        ),
    ],
    throughput: Annotated[
        bool,
        typer.Option("--throughput", help="Measure evaluations per second, by compiled C and JAX."),
    ] = False,
    json: Json = False,
) -> None:
    """Count the operations of a table's exported functions, by kind.

    The closed form is counted too if the table's form has two stages (ps).
    """
    require_tables([table])
    from coefficients.catalogue import resolve
    from coefficients.code_header import closed_form_beside, costs
    from programs import KINDS, measure_throughput
    from shadefit.code_records import CostedTable
    from shadefit.commands.table_records import entry_fields
    from shadefit.outputs import CostOutput
    from shadefit.terminal import print_json, print_table

    entry = resolve(table)
    functions = entry.functions()
    labelled = [(_when(functions, function), function) for function in functions]
    beside = closed_form_beside(entry)
    if beside is not None:
        labelled += [(f"a direction, {beside.name}", each) for each in beside.functions()]
    counted = costs([function for _, function in labelled])
    rates = {f.name: measure_throughput(f) for _, f in labelled} if throughput else {}
    if json:
        record = [
            _record(when, function, counted[function.name], rates.get(function.name))
            for when, function in labelled
        ]
        print_json(CostOutput(tables=[CostedTable(**entry_fields(entry), functions=record)]))
        return
    alone = entry.fitted is not None and beside is None
    note = "No exact form is exported beside it." if alone else ""
    print_table(
        f"{table}: operations",
        ["function", *KINDS, "fma", "operations", "weighted", "for"],
        [_row(when, function.name, counted[function.name]) for when, function in labelled],
        "select: comparisons, selections, minima, maxima, roundings. sign: negations, absolute "
        "values; not among the operations. fma: additions that could take up a product, counted in "
        f"both. {note}".strip(),
        below=1,
    )
    if rates:
        _print_rates(table, rates)


def _print_rates(table: str, rates: "dict[str, Throughput]") -> None:
    from shadefit.terminal import print_table

    print_table(
        f"{table}: evaluations a second in float32",
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


def _when(functions: "Sequence[Function]", function: "Function") -> str:
    if len(functions) == 1:
        return "a point"
    return "a direction" if function is functions[-1] else "a material"


def _row(when: str, name: str, cost: "Cost") -> list[str]:
    from programs import KINDS

    kinds = [str(getattr(cost, kind)) for kind in (*KINDS, "fma", "operations", "weighted")]
    return [name, *kinds, when]


def _record(
    when: str, function: "Function", cost: "Cost", rate: "Throughput | None"
) -> "FunctionRecord":
    from dataclasses import asdict

    from shadefit.code_records import FunctionRecord

    return FunctionRecord(
        function=function.name,
        evaluated_for=when,
        operations=cost.operations,
        weighted=cost.weighted,
        kinds=asdict(cost),
        throughput=None if rate is None else _rate(rate),
    )


def _rate(rate: "Throughput") -> "ThroughputRecord":
    from dataclasses import asdict

    from shadefit.code_records import ThroughputRecord

    return ThroughputRecord.model_validate({**asdict(rate), "ratio": rate.ratio})
