"""`shadefit compare`: print the errors of tables beside those of the published ones."""

from typing import TYPE_CHECKING, Annotated

import typer

from shadefit.commands.names import require_tables
from shadefit.commands.options import Json
from shadefit.completion import complete_table

if TYPE_CHECKING:
    from coefficients.catalogue import Entry
    from coefficients.compare import Comparison
    from shadefit.records import ComparisonRecord

# Coefficients are printed only if there are at most this many. --json prints them all.
PRINTED_COEFFICIENTS = 17


def compare(
    tables: Annotated[
        list[str] | None,
        typer.Argument(
            help="Names or paths of tables; by default the refits of all published tables.",
            autocompletion=complete_table,
        ),
    ] = None,
    json: Json = False,
) -> None:
    """Compare the errors of tables with those of the published tables.

    Errors are measured against the exact integral, at the same points for both.
    """
    run(tables or [], json)


def run(names: list[str], json: bool) -> None:
    """Compare each table with the published one of its quantity."""
    require_tables(names)
    from coefficients.catalogue import resolve, with_published
    from coefficients.compare import compare
    from shadefit.outputs import CompareOutput
    from shadefit.terminal import print_json

    chosen = [resolve(name) for name in names or [owner.name for owner in with_published()]]
    labelled = [contestants(entry) for entry in chosen]
    comparisons = [compare(each) for each in labelled]
    if json:
        records = [record(*each) for each in zip(comparisons, labelled, strict=True)]
        print_json(CompareOutput(comparisons=records))
        return
    for comparison in comparisons:
        _print(comparison)


def record(comparison: "Comparison", labelled: "list[tuple[str, Entry]]") -> "ComparisonRecord":
    """Return a comparison of entries as it is printed by --json, coefficients included."""
    from shadefit.commands.table_records import entry_fields
    from shadefit.records import ComparedTable, ComparisonRecord, LargestDifference, Ratios

    tables = [
        ComparedTable(
            **entry_fields(entry, each.errors),
            label=each.label,
            ratios=Ratios(rms=each.rms_ratio, max=each.largest_ratio),
            coefficients=each.table.coefficients,
        )
        for each, (_, entry) in zip(comparison.contestants, labelled, strict=True)
    ]
    return ComparisonRecord(
        quantity=comparison.quantity,
        domain={axis.name: [axis.lower, axis.upper] for axis in comparison.domain.axes},
        tables=tables,
        coefficient_names=comparison.contestants[0].table.coefficient_names,
        largest_difference=LargestDifference(value=comparison.difference, where=comparison.where),
    )


def contestants(entry: "Entry") -> "list[tuple[str, Entry]]":
    """Return the entries to compare, with labels: the published tables of the quantity, then it."""
    from coefficients.catalogue import printed, published

    entry.require_table()
    corrected, as_printed = published(entry.problem), printed(entry.problem)
    if corrected is None:
        return [(entry.name, entry)]
    labelled = [("published", corrected)]
    if as_printed is not None:
        labelled = [("published, corrected", corrected), ("published, as printed", as_printed)]
    if entry.kind not in ("published", "printed"):
        labelled.append(
            (f"refitted {entry.name}" if entry.kind == "refitted" else entry.name, entry)
        )
    return labelled


def _print(comparison: "Comparison") -> None:
    from coefficients.compare import coefficient_rows
    from shadefit.terminal import place, print_table

    first = comparison.contestants[0]
    domain = ", ".join(f"{axis.name} in {axis.domain}" for axis in comparison.domain.axes)
    print_table(
        f"{comparison.quantity}: {first.table.form}, {first.errors.points:,} points off the grid",
        ["table", "rms error", "ratio", "largest error", "ratio", "at"],
        [
            [
                each.label,
                f"{each.errors.rms:.4e}",
                f"{each.rms_ratio:.4f}",
                f"{each.errors.largest:.4e}",
                f"{each.largest_ratio:.4f}",
                place(each.errors.where),
            ]
            for each in comparison.contestants
        ],
        f"Measured for {domain}. The last differs from the first by at most "
        f"{comparison.difference:.3e}, at {place(comparison.where)}.",
        below=1,
    )
    same = len({each.table.form for each in comparison.contestants}) == 1
    rows = coefficient_rows(comparison) if same else []
    if 0 < len(rows) <= PRINTED_COEFFICIENTS:
        print_table(
            f"{comparison.quantity}: coefficients",
            ["coefficient", *(each.label for each in comparison.contestants)],
            [[name, *(f"{value:.7f}" for value in values)] for name, values in rows],
            "Other coefficients may give almost the same function: compare the errors.",
        )
    elif rows:
        print(f"{len(rows)} coefficients: --json prints them.\n")
