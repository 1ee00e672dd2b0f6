"""`shadefit compare`: refitted and published tables side by side."""

from coefficients.catalogue import AS_PRINTED, PUBLISHED, corrected, load
from coefficients.compare import Comparison, as_json, coefficient_rows, compare
from coefficients.table import Table
from shadefit.terminal import place, print_json, print_table

# Up to this many coefficients are printed; --json has them all.
PRINTED_COEFFICIENTS = 17


def run(names: list[str], json: bool) -> None:
    """Compare each table with the published one of its quantity."""
    comparisons = [compare(_contestants(load(name), name)) for name in names or PUBLISHED]
    if json:
        print_json({"comparisons": [as_json(comparison) for comparison in comparisons]})
        return
    for comparison in comparisons:
        _print(comparison)


def _contestants(table: Table, name: str) -> list[tuple[str, Table]]:
    if table.quantity not in PUBLISHED:
        return [(name, table)]
    published = f"published/{table.quantity}"
    labelled = [("published", load(published))]
    printed = load(published + AS_PRINTED)
    if printed != corrected(printed):
        labelled = [("published, corrected", load(published)), ("published, as printed", printed)]
    if name not in (published, published + AS_PRINTED):
        labelled.append((name if "/" in name else f"refitted {name}", table))
    return labelled


def _print(comparison: Comparison) -> None:
    first = comparison.entries[0]
    domain = ", ".join(f"{axis.name} in {axis.domain}" for axis in comparison.domain.axes)
    print_table(
        f"{comparison.quantity}: {first.table.equation}, "
        f"{first.errors.points:,} points off the grid",
        ["table", "rms error", "ratio", "largest error", "ratio", "at"],
        [
            [
                entry.label,
                f"{entry.errors.rms:.4e}",
                f"{entry.rms_ratio:.4f}",
                f"{entry.errors.largest:.4e}",
                f"{entry.largest_ratio:.4f}",
                place(entry.errors.where),
            ]
            for entry in comparison.entries
        ],
        f"Measured for {domain}. The last differs from the first by at most "
        f"{comparison.difference:.3e}, at {place(comparison.where)}.",
    )
    rows = coefficient_rows(comparison) if _same_form(comparison) else []
    if 0 < len(rows) <= PRINTED_COEFFICIENTS:
        print_table(
            f"{comparison.quantity}: coefficients",
            ["coefficient", *(entry.label for entry in comparison.entries)],
            [[name, *(f"{value:.7f}" for value in values)] for name, values in rows],
            "Rational coefficients are far from unique: the functions count.",
        )
    elif rows:
        print(f"{len(rows)} coefficients: --json prints them.\n")


def _same_form(comparison: Comparison) -> bool:
    return len({entry.table.form for entry in comparison.entries}) == 1
