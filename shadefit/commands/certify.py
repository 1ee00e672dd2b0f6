"""`shadefit certify`: prove the largest errors of tables, or the rounding of their code."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from shadefit.commands.options import Json
from shadefit.completion import complete_table

if TYPE_CHECKING:
    from coefficients.catalogue import Entry
    from coefficients.certify import Certification
    from coefficients.rounding import RoundingBounds
    from shadefit.code_records import CertifiedTable


def certify(
    tables: Annotated[
        list[str],
        typer.Argument(
            help="Names or paths of tables; 'all' for the packaged ones that were fitted.",
            autocompletion=complete_table,
        ),
    ],
    upper_ratio: Annotated[
        float | None,
        typer.Option(
            help="Largest quotient of the proven bound and the largest error found; by default "
            "1.01; with --rounding 1.2, and 1.25 for more than two variables."
        ),
    ] = None,
    at_most: Annotated[
        float | None,
        typer.Option(help="Prove that no error is above this, or find a point where one is."),
    ] = None,
    rounding: Annotated[
        bool,
        typer.Option(
            "--rounding", help="Prove what rounding to float32 adds to the error of exported code."
        ),
    ] = False,
    threads: Annotated[int, typer.Option(min=1, max=256, help="Threads of the search.")] = 2,
    out: Annotated[
        Path | None,
        typer.Option(help="Folder to write the tables to, with their proven largest errors."),
    ] = None,
    json: Json = False,
) -> int:
    """Prove a bound of the largest error of tables on their whole domains.

    This needs a C compiler, and a closed form of the exact value or bounds of it,
    as R has; other quantities are 'sampled'. The exit status is 1 if a bound is
    refuted or not proven, or if a table states less than an error that was found
    ('understated'). With --rounding, no exact value is needed, and exact/NAME is
    allowed too.
    """
    from coefficients.certify import RATIO, chosen, with_largest_error
    from coefficients.certify import certify as certify_entry
    from coefficients.files import require_writable
    from coefficients.rounding import certify_rounding, with_rounding
    from shadefit.outputs import CertifyOutput
    from shadefit.terminal import print_json

    if at_most is not None and not at_most > 0:
        raise ValueError(f"--at-most {at_most:g}: allowed is a positive number")
    if at_most is not None and rounding:
        raise ValueError("--at-most with --rounding: allowed is one of them")
    if out is not None:
        require_writable(out)
    entries = chosen(tables, closed_forms=rounding)
    if rounding:
        found = _each(
            entries,
            lambda entry, report: certify_rounding(
                entry, upper_ratio, threads=threads, progress=report
            ),
            with_rounding,
            out,
        )
        understated = False
        record, show = _rounding_record, _print_rounding
    else:
        ratio = RATIO if upper_ratio is None else upper_ratio
        found = _each(
            entries,
            lambda entry, report: certify_entry(
                entry, ratio, claim=at_most, threads=threads, progress=report
            ),
            with_largest_error,
            out,
        )
        understated = any(each.understated for each in found)
        record, show = _record, _print
    if json:
        print_json(CertifyOutput(tables=[record(each) for each in found]))
    else:
        show(found)
    failed = any(each.state in ("refuted", "not proven") for each in found)
    return 1 if failed or understated else 0


def _each(
    entries: "Sequence[Entry]", prove: Callable, certified: Callable, out: Path | None
) -> list:
    """Return what `prove(entry, report)` finds for each entry, and show how far it is.

    With `out`, the table `certified(found)` of each that is proven is written there at once.
    """
    from coefficients.files import write_whole
    from coefficients.stated_errors import require_stated
    from coefficients.table import serialise
    from shadefit.progress import stages

    done = []
    with stages() as progress:
        line = progress.begin("tables", total=len(entries))
        for entry in entries:
            line.show(f"{entry.name}: preparing the search")
            if out is not None:
                require_stated(entry)

            def report(standing, name: str = entry.name) -> None:
                line.show(_standing(name, standing))

            found = prove(entry, report)
            done.append(found)
            line.advance()
            has_certificates = entry.table is not None and entry.table.certificates is not None
            if out is not None and has_certificates and found.state == "proven":
                text = serialise(certified(found))
                write_whole(out / f"{entry.require_table().name}.json", text)
    return done


def _rounding_record(each: "RoundingBounds") -> "CertifiedTable":
    from shadefit.code_records import CertifiedTable, RoundingRecord
    from shadefit.commands.table_records import entry_fields

    upper = {name: None if found is None else found.upper for name, found in each.found.items()}
    return CertifiedTable(
        **entry_fields(each.entry),
        state=each.state,
        largest_error=None,
        understated=False,
        rounding=RoundingRecord(upper=upper, measured=each.measured),
    )


def _print_rounding(done: "list[RoundingBounds]") -> None:
    from programs.bounding.rounding_model import MODELS
    from programs.rounded_text import rounded_up
    from shadefit.terminal import print_table

    def bound(found) -> str:
        return "—" if found is None or found.upper is None else rounded_up(found.upper, 3)

    print_table(
        "What rounding to float32 adds to errors on the whole domain",
        ["table", "state", *(f"at most: {name}" for name in MODELS), "measured", "boxes"],
        [
            [
                each.entry.name,
                each.state,
                *(bound(found) for found in each.found.values()),
                rounded_up(each.measured, 3),
                f"{sum(found.boxes for found in each.found.values() if found):,}",
            ]
            for each in done
        ],
        "; ".join(f"{name}: {model.arithmetic}" for name, model in MODELS.items())
        + ". measured: the largest at fixed points, every operation rounded to nearest.",
    )


def _standing(name: str, standing) -> str:
    seconds = standing.remaining
    left = f", about {seconds:.0f} s left" if seconds < 1e6 else ""
    return (
        f"{name}: {100 * standing.part:.1f} % proven, {standing.boxes:,} boxes, "
        f"largest error found {standing.lower:.4g}{left}"
    )


def _record(each: "Certification") -> "CertifiedTable":
    from shadefit.code_records import CertifiedTable, LargestErrorRecord
    from shadefit.commands.table_records import entry_fields

    found = each.found
    largest = None
    if found is not None:
        largest = LargestErrorRecord(
            lower=found.lower, at=found.at, upper=found.upper, boxes=found.boxes
        )
    return CertifiedTable(
        **entry_fields(each.entry),
        state=each.state,
        largest_error=largest,
        understated=each.understated,
    )


def _print(done: "list[Certification]") -> None:
    from shadefit.terminal import print_table

    print_table(
        "Largest errors on the whole domain",
        ["table", "state", "at least", "at most", "stated", "boxes", "at"],
        [_row(each) for each in done],
        "proven: no error on the domain is above 'at most'. sampled: there is no closed form, and "
        "the stated error is the largest of those measured.",
    )


def _row(each: "Certification") -> list[str]:
    from programs.rounded_text import rounded_down, rounded_up
    from shadefit.terminal import place

    state = each.state + (", understated" if each.understated else "")
    stated = "—" if each.stated is None else f"{each.stated:.6g}"
    found = each.found
    if found is None:
        return [each.entry.name, state, "—", "—", stated, "—", "—"]
    upper = "—" if found.upper is None else rounded_up(found.upper, 6)
    lower = rounded_down(found.lower, 6)
    return [each.entry.name, state, lower, upper, stated, f"{found.boxes:,}", place(found.at)]
