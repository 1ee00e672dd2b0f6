"""`shadefit verify`: compile and run exported code, and compare it with exact values."""

from typing import TYPE_CHECKING, Annotated

import typer

from shadefit.commands.options import Json
from shadefit.completion import complete_language, complete_shader

if TYPE_CHECKING:
    from programs import Check


def verify(
    tables: Annotated[
        list[str],
        typer.Argument(
            help="Names or paths of tables, or exact/NAME, a closed form.",
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
    from dataclasses import asdict

    from coefficients.catalogue import resolve
    from coefficients.exported_code import trial_of
    from programs import LANGUAGES, check, language
    from shadefit.terminal import print_json, stages

    languages = list(LANGUAGES) if to == "all" else [language(to).key]
    kinds = _precisions(languages, precision)
    checks: dict[str, list[Check]] = {}
    with stages() as progress:
        task = progress.add_task("")
        for name in tables:
            entry = resolve(name)
            checks[name] = []
            for kind, some in kinds.items():
                trial = trial_of(entry, kind)
                for each in some:
                    progress.update(task, description=f"{name} in {each}, {kind}")
                    checks[name].append(check(trial, each))
    if json:
        print_json({"tables": {name: list(map(asdict, rows)) for name, rows in checks.items()}})
    else:
        for name, rows in checks.items():
            _print(name, rows)
    every = [each for rows in checks.values() for each in rows]
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
        f"{name}: exported code against its float64 form and the exact integral",
        [
            *("language", "precision", "status", "points", "form: largest", "rms"),
            *("ULP: largest", "rms", "allowed", "rms", "integral: largest", "rms", "not finite"),
        ],
        [_row(each) for each in checks],
        f"allowed: {SLACK:g} times the error of the same operations, each correctly rounded.",
    )
    for each in checks:
        if each.reason is not None:
            print(f"{each.language} in {each.precision}: {each.status}: {each.reason}")
    tools = {each.language: each for each in checks if each.tool is not None}
    for language, each in tools.items():
        print(f"{language}: {each.tool}; {each.note}")
    print()


def _row(each: "Check") -> list[str]:
    row = [each.language, each.precision, each.status]
    if each.form is None or each.units is None or each.allowed is None or each.integral is None:
        return [*row, *["—"] * 10]
    return [
        *row,
        f"{each.points:,}",
        f"{each.form.largest:.1e}",
        f"{each.form.rms:.1e}",
        f"{each.units.largest:.1f}",
        f"{each.units.rms:.2f}",
        f"{each.allowed.largest:.1e}",
        f"{each.allowed.rms:.1e}",
        f"{each.integral.largest:.2e}",
        f"{each.integral.rms:.2e}",
        str(each.form.not_finite),
    ]
