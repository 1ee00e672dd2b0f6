"""The exported functions of an entry: their values, verification, and source files."""

import functools
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from coefficients.bundles import Bundle, bundle
from coefficients.catalogue import Entry
from coefficients.code_header import cost_text, costs, header_of
from coefficients.code_options import (
    DEFAULTS,
    CodeOptions,
    joined,
    prefixed,
    require_use,
    shaped,
    words_of,
)
from fitting.points.grids import sobol_points
from fitting.points.scattered import data_points
from programs import (
    CallSequence,
    Function,
    Language,
    Program,
    Trial,
    count_operations,
    evaluate,
    language,
    precision_of,
    trace,
    write_source,
)
from programs.printing.comments import command_text
from programs.printing.printer import Section, write_sections
from programs.toolchains.verification import corners
from quantities.loader import option_for

# Code is run at 2^EXPONENT points and at the corners of the domain.
EXPONENT = 17
SEED = 20200718
LICENCE_LABEL, LICENCE = "SPDX-License-Identifier", "Apache-2.0"


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


def source_file(
    entries: Entry | Sequence[Entry],
    key: str,
    precision: str | None = None,
    function_name: str | None = None,
    constants: str = "inline",
    options: CodeOptions = DEFAULTS,
    made_by: str | None = None,
) -> str:
    """Return the source file of entries; its header states domain, errors, proofs and cost.

    Arguments: `entries`, one, or several whose functions have different names; `key`, the name of a
    language; `precision`, None for float (JavaScript: double); `function_name`, None for the
    quantity's own, and only for one entry; `constants`, "inline" or "table"; `options`; `made_by`,
    a text for the header in place of the command line. On one machine, the same call returns the
    same bytes. Raises ValueError for what cannot be written.
    """
    listed = [entries] if isinstance(entries, Entry) else list(entries)
    hosted = None if options.bundle is None else bundle(options.bundle)
    if function_name is not None and len(listed) > 1:
        raise ValueError(f"name {function_name!r} is for one table; allowed for more: prefix")
    spelled = language(key)
    kind = precision_of(spelled.key, precision)
    require_use(options, [entry.problem for entry in listed])
    chosen = [shaped(entry, options) for entry in listed]
    called = [prefixed(each.functions(kind, function_name), options.prefix) for each in chosen]
    if hosted is not None:
        _require_bundle(hosted, options, spelled, kind, listed, called, constants)
    holds_code = hosted is None or hosted.holds_code
    guard = _guard(listed, precision, function_name or options.together, options.prefix)
    printed = called
    if options.together is not None:
        if hosted is not None:
            raise ValueError(f"together {options.together!r}: allowed without a bundle")
        whole = joined(called, options.prefix + options.together)
        printed = [*((),) * (len(called) - 1), (whole,)]

    def written(headers: Sequence[Mapping[str, str]]) -> str:
        source = write_sections(
            [Section(*pair) for pair in zip(printed, headers, strict=True)],
            spelled,
            kind,
            constants=constants,
            guard=guard,
            namespace=options.namespace,
            ending=[] if hosted is None else hosted.code(called),
        )
        if hosted is None or hosted.document is None:
            return source
        return hosted.document(called, headers, source)

    # The source is first written without its header: if that is not possible, no time is spent on
    # measurements.
    written([{}] * len(listed))
    if made_by is None:
        given = {"--precision": precision, "--name": function_name}
        given |= {"--constants": None if constants == "inline" else constants}
        target = ["--to", spelled.key] if holds_code else []
        made_by = _command(listed, target, given, options)
    headers = []
    for entry, functions in zip(chosen, called, strict=True):
        trial = trial_of(entry, kind)
        trial = replace(trial, calls=replace(trial.calls, functions=functions))
        bare = write_source(functions, spelled, kind, constants=constants)
        # The function of all tables is not run for the error of one.
        run = bare if holds_code and printed is called else None
        headers.append(header_of(entry, trial, spelled.key, run, made_by))
    if printed is not called:
        ((name, cost),) = costs(printed[-1]).items()
        headers[-1] |= {"Cost of all together": f"{name}: {cost_text(cost)}"}
    headers[0] = {LICENCE_LABEL: LICENCE, **headers[0]}
    return written(headers)


def _require_bundle(
    hosted: Bundle,
    options: CodeOptions,
    spelled: Language,
    precision: str,
    entries: Sequence[Entry],
    called: Sequence[tuple[Function, ...]],
    constants: str,
) -> None:
    """Raise ValueError if a bundle cannot have these functions in this language."""
    name = f"bundle {options.bundle!r}"
    if (spelled.key, precision) != (hosted.language, "float"):
        raise ValueError(
            f"{name} is not for {spelled.name} in {precision}: allowed is {hosted.language} in "
            "float"
        )
    if len(called) > 1 and not hosted.several:
        raise ValueError(f"{name} is of {len(called)} tables; allowed: one")
    for entry, functions in zip(entries, called, strict=True):
        if functions[-1].result is not None:
            raise ValueError(
                f"{name} is of functions of one value: {entry.name} has {functions[-1].result}"
            )
    if not hosted.holds_code and (constants, options.layout) != ("inline", DEFAULTS.layout):
        raise ValueError(
            f"{name} holds no code; allowed are constants 'inline' and layout {DEFAULTS.layout!r}"
        )


def _command(
    entries: Sequence[Entry],
    target: list[str],
    given: Mapping[str, str | None],
    options: CodeOptions,
) -> str:
    """Return the command that writes the code of entries, with the options that are given."""
    command = ["shadefit", "export", *option_for(entries[0].problem)]
    command += [*(entry.name for entry in entries), *target]
    command += [word for flag, value in given.items() if value for word in (flag, value)]
    return command_text([*command, *words_of(options)])


def _guard(
    entries: Sequence[Entry], precision: str | None, function_name: str | None, prefix: str
) -> str:
    """Return the name of an include guard, different for files of different functions."""
    names = [entry.name for entry in entries]
    parts = ["shadefit", prefix, *names, function_name or "", precision or ""]
    return re.sub(r"[^A-Z0-9]+", "_", "_".join(parts).upper()).strip("_")
