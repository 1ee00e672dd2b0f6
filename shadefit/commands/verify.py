"""`shadefit verify`: compile and run exported code, and compare it with exact values."""

from typing import TYPE_CHECKING, Annotated

import typer

from shadefit.commands.names import require_tables
from shadefit.commands.options import Json
from shadefit.completion import complete_language, complete_shader

if TYPE_CHECKING:
    from programs.toolchains.verification import Check, Difference
    from shadefit.code_records import CheckRecord, CodeErrors

ADVICE = "in a checkout, 'make toolchains' installs the compilers that are missing"


def verify(
    tables: Annotated[
        list[str],
        typer.Argument(
            help="Names or paths of tables, or names of functions, such as exact/ps or "
            "detail/overlay.",
            autocompletion=complete_shader,
        ),
    ],
    to: Annotated[
        str,
        typer.Option(help="Language of the code, or all.", autocompletion=complete_language),
    ] = "all",
    precision: Annotated[
        str | None,
        typer.Option(help="half, float, double or all; by default float, for JavaScript double."),
    ] = None,
    json: Json = False,
) -> int:
    """Compile and run exported code. Compare it with its form and with the exact integral.

    The exit status is 1 if any language failed. A language whose compiler
    is not installed is 'not checked'.
    """
    from programs.languages import LANGUAGES, language

    require_tables(tables)
    languages = list(LANGUAGES) if to == "all" else [language(to).key]
    kinds = _precisions(languages, precision)
    from coefficients.catalogue import resolve
    from coefficients.exported_code import trial_of
    from programs import check, toolchain
    from shadefit.code_records import VerifiedTable
    from shadefit.commands.table_records import entry_fields
    from shadefit.outputs import VerifyOutput
    from shadefit.progress import stages
    from shadefit.terminal import print_json

    entries = {name: resolve(name) for name in tables}
    checks: dict[str, list[Check]] = {}
    with stages() as progress:
        line = progress.begin("", total=len(entries) * sum(map(len, kinds.values())))
        for name, entry in entries.items():
            checks[name] = []
            for kind, some in kinds.items():
                line.show(f"{name}, {kind}: exact values")
                trial = trial_of(entry, kind)
                for each in some:
                    line.show(f"{name} in {each}, {kind}")
                    checks[name].append(check(trial, each))
                    line.advance()
    every = [each for rows in checks.values() for each in rows]
    if json:
        records = [
            VerifiedTable(**entry_fields(entries[name]), checks=list(map(_record, rows)))
            for name, rows in checks.items()
        ]
        print_json(VerifyOutput(tables=records))
    else:
        for name, rows in checks.items():
            _print(name, rows)
        left_out = [each for each in every if each.status == "not checked"]
        if left_out:
            missing = any(toolchain(each.language).missing(each.precision) for each in left_out)
            advice = f": {ADVICE}" if missing else ""
            print(f"{len(left_out)} of {len(every)} not checked{advice}")
    return 1 if any(each.status == "failed" for each in every) else 0


def _precisions(languages: list[str], precision: str | None) -> dict[str, list[str]]:
    """Return the languages to check, by precision.

    Raises ValueError if a single language does not have the precision that is asked for. If all
    languages are checked, those that do not have it are reported as not checked.
    """
    from programs import PRECISIONS, language, precision_of

    if precision == "all":
        if len(languages) == 1:
            return {kind: languages for kind in language(languages[0]).types}
        return {kind: languages for kind in PRECISIONS}
    if precision is not None and len(languages) > 1:
        if precision not in PRECISIONS:
            raise ValueError(f"precision is {precision!r}; allowed: {', '.join(PRECISIONS)}, all")
        return {precision: languages}
    kinds: dict[str, list[str]] = {}
    for each in languages:
        kinds.setdefault(precision_of(each, precision), []).append(each)
    return kinds


def _print(name: str, checks: "list[Check]") -> None:
    from programs.toolchains.verification import SLACK
    from shadefit.terminal import print_table

    print_table(
        f"{name}: exported code against its float64 form and the exact values",
        [
            *("language", "precision", "status", "form: largest", "allowed"),
            *("integral: largest", "integral: rms", "form: rms", "allowed rms"),
            *("ULP: largest", "ULP: rms", "not finite", "points"),
        ],
        [_row(each) for each in checks],
        f"allowed: {SLACK:g} times the error of the same operations, each correctly rounded.",
        below=6,
    )
    for each in checks:
        if each.reason is not None:
            print(f"{each.language} in {each.precision}: {each.status}: {each.reason}")
    tools = {each.language: each for each in checks if each.tool is not None}
    for language, each in tools.items():
        print(f"{language}: {each.tool}; {each.note}")
    print()


def _record(check: "Check") -> "CheckRecord":
    from shadefit.code_records import CheckRecord

    points = {name: check.points for name in ("form", "units", "allowed")}
    points["integral"] = check.integral_points
    own = ("language", "precision", "status", "reason", "tool", "note")
    return CheckRecord.model_validate(
        {
            **{name: getattr(check, name) for name in own},
            **{name: _errors(getattr(check, name), count) for name, count in points.items()},
        }
    )


def _errors(difference: "Difference | None", points: int) -> "CodeErrors | None":
    from shadefit.code_records import CodeErrors

    if difference is None:
        return None
    return CodeErrors(
        rms=difference.rms,
        max=difference.largest,
        points=points,
        not_finite=difference.not_finite,
    )


def _row(each: "Check") -> list[str]:
    row = [each.language, each.precision, each.status]
    if each.form is None or each.units is None or each.allowed is None:
        return [*row, *["—"] * 4, *[""] * 6]
    return [
        *row,
        f"{each.form.largest:.1e}",
        f"{each.allowed.largest:.1e}",
        "—" if each.integral is None else f"{each.integral.largest:.2e}",
        "—" if each.integral is None else f"{each.integral.rms:.2e}",
        f"{each.form.rms:.1e}",
        f"{each.allowed.rms:.1e}",
        f"{each.units.largest:.1f}",
        f"{each.units.rms:.2f}",
        str(each.form.not_finite),
        f"{each.points:,}",
    ]
