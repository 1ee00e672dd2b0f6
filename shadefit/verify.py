"""`shadefit verify`: exported code compiled, run and compared, a row a language."""

from dataclasses import asdict

from coefficients.shaders import shader
from coefficients.verify import SLACK, Check, Problem, check, precision_of
from programs.languages import PRECISIONS, TARGETS, target
from shadefit.terminal import print_json, print_table, stages


def run(names: list[str], language: str, precision: str | None, json: bool) -> int:
    """Verify tables in one language or all; gives the exit status: 1 if any failed, else 0."""
    languages = list(TARGETS) if language == "all" else [target(language).key]
    kinds = _precisions(languages, precision)
    checks: dict[str, list[Check]] = {}
    with stages() as progress:
        task = progress.add_task("")
        for name in names:
            checks[name] = []
            for kind, some in kinds.items():
                problem = Problem(shader(name, kind), kind)
                for each in some:
                    progress.update(task, description=f"{name} in {each}, {kind}")
                    checks[name].append(check(problem, each))
    if json:
        print_json({"tables": {name: list(map(asdict, rows)) for name, rows in checks.items()}})
    else:
        for name, rows in checks.items():
            _print(name, rows)
    every = [each for rows in checks.values() for each in rows]
    return 1 if any(each.status == "failed" for each in every) else 0


def _precisions(languages: list[str], precision: str | None) -> dict[str, list[str]]:
    """Give the languages to check in each precision.

    One language must have the precision that is asked for; of all, those that have it not are
    reported as not checked.
    """
    if precision == "all":
        if len(languages) == 1:
            return {kind: languages for kind in target(languages[0]).types}
        return {kind: languages for kind in PRECISIONS}
    if precision is not None and len(languages) > 1:
        if precision not in PRECISIONS:
            raise ValueError(f"precision is {precision!r}; allowed: {', '.join(PRECISIONS)}, all")
        return {precision: languages}
    kinds: dict[str, list[str]] = {}
    for language in languages:
        kinds.setdefault(precision_of(language, precision), []).append(language)
    return kinds


def _print(name: str, checks: list[Check]) -> None:
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


def _row(each: Check) -> list[str]:
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
