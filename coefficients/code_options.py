"""How the exported code of an entry is to look: its interface, arguments and names."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from coefficients.catalogue import Entry
from programs import Function, Record
from programs.functions import Layout, function
from quantities import Problem

Interface = Literal["listing", "material"]


@dataclass(frozen=True)
class CodeOptions:
    """Choices about exported code.

    * `interface`: of a form of two stages. "listing" is that of the paper: Calc…Coeffs fills an
      array of some length. "material" is the same for every table and for the closed form:
      …Material returns a structure, which …(material, …) takes.
    * `layout`: what this structure, or the one that a sampler returns, contains
      (`programs.Record`).
    * `cosines`: whether arguments that are angles are replaced by their cosines.
    * `prefix`: what the names of functions and structures begin with.
    * `namespace`: that of all functions, in languages that have namespaces.
    * `together`: the name of one function that returns the values of all tables in an array; what
      they share, such as a denominator, is computed once. None: each table has its own function.
    * `bundle`: a program that hosts shaders, whose entry points are added (`coefficients.bundles`).
    """

    interface: Interface = "listing"
    layout: Layout = "array"
    cosines: bool = False
    prefix: str = ""
    namespace: str | None = None
    bundle: str | None = None
    together: str | None = None


DEFAULTS = CodeOptions()


def shaped(entry: Entry, options: CodeOptions) -> Entry:
    """Return an entry whose exported functions have the interface and arguments of `options`."""
    calling, exact = entry.problem.calling, entry.problem.exact_code
    record = None
    if options.interface == "material" and calling.material is not None:
        record = Record(calling.material, options.layout)
    remark = calling.remark
    if options.cosines and remark is not None:
        for argument in calling.arguments:
            if argument.cosine is not None:
                remark = remark.replace(argument.name, f"acos({argument.cosine})")
    calling = replace(calling, cosines=options.cosines, record=record, remark=remark)
    if exact is not None and exact.staged is not None and record is not None:
        staged, angles = exact.staged, calling

        def arguments_at(points: np.ndarray) -> tuple[np.ndarray, ...]:
            assert angles.columns is not None
            shared = points[:, : len(angles.arguments)]
            return angles.with_cosines(shared), angles.columns(points)

        exact = replace(
            exact,
            functions=lambda precision: staged(precision, record, options.cosines),
            arguments_at=arguments_at,
        )
    elif exact is not None and options.layout != DEFAULTS.layout:
        alone = exact.functions
        exact = replace(exact, functions=lambda kind: _laid_out(alone(kind), options.layout))
    return replace(entry, problem=entry.problem.changed(calling=calling, exact_code=exact))


def words_of(options: CodeOptions) -> list[str]:
    """Return the words of a command line that stand for options, but for those by default."""
    words = []
    for name in ("interface", "layout", "prefix", "namespace", "bundle", "together"):
        value = getattr(options, name)
        if value != getattr(DEFAULTS, name):
            words += [f"--{name}", value]
    return [*words, *(["--cosines"] if options.cosines else [])]


def require_use(options: CodeOptions, problems: Sequence[Problem]) -> None:
    """Raise ValueError for options that change nothing about the code of these quantities."""
    callings = [each.calling for each in problems]
    names = ", ".join(dict.fromkeys(each.name for each in problems))
    structures = options.interface == "material" or all(map(_returns_structure, problems))
    if options.layout != "array" and not structures:
        raise ValueError(
            f"layout {options.layout!r} is for structures: allowed with interface material"
        )
    one_call = options.bundle is None and all(each.material is None for each in callings)
    if options.interface == "material" and one_call:
        raise ValueError(f"interface 'material' is for tables of two functions: {names} has one")
    if options.cosines and not any(a.cosine for each in callings for a in each.arguments):
        raise ValueError(f"cosines stand for angles: {names} takes no angle")


def _returns_structure(owner: Problem) -> bool:
    """Return whether the exact code of a quantity has functions that return structures of numbers.

    Structures of vectors have only one layout.
    """
    exact = owner.exact_code
    records = [each.record for each in exact.functions("float")] if exact is not None else []
    return any(record is not None and not record.vectors for record in records)


def _laid_out(functions: tuple[Function, ...], layout: Layout) -> tuple[Function, ...]:
    return tuple(
        each if each.record is None else replace(each, record=replace(each.record, layout=layout))
        for each in functions
    )


def joined(called: Sequence[tuple[Function, ...]], name: str) -> Function:
    """Return one function that returns the values of several functions of the same arguments.

    `called` has the functions of each table, of one value each. Raises ValueError for a single
    table, for one of two functions or of several values, and for other arguments.
    """
    if len(called) < 2:
        raise ValueError(f"together {name!r} is of one table; allowed: at least 2")
    for first, *more in called:
        if more:
            raise ValueError(f"together {name!r}: {more[-1].name} is one of two functions")
        if first.result is not None:
            raise ValueError(f"together {name!r}: {first.name} has {first.result} values, not one")
        if first.parameters != called[0][0].parameters:
            raise ValueError(
                f"together {name!r}: {first.name} has other arguments or domains than "
                f"{called[0][0].name}"
            )
    calls = [each.call for (each,) in called]

    def values(*given: Any) -> tuple[Any, ...]:
        return tuple(call(*given) for call in calls)

    listed = ", ".join(each.name for (each,) in called)
    summary = f"The values of {listed}, in this order; clamps to the domain."
    return function(name, called[0][0].parameters, values, summary, len(calls), "values")


def prefixed(functions: tuple[Function, ...], prefix: str) -> tuple[Function, ...]:
    """Put a prefix before the names of functions and of the structures that they use."""
    if not prefix:
        return functions
    names = [each.name for each in functions]

    def renamed(record: Record | None) -> Record | None:
        return None if record is None else replace(record, name=prefix + record.name)

    changed = []
    for each in functions:
        summary = each.summary
        for name in names:
            summary = summary.replace(f"{name} ", f"{prefix}{name} ")
        parameters = tuple(replace(p, record=renamed(p.record)) for p in each.parameters)
        changed.append(
            replace(
                each,
                name=prefix + each.name,
                summary=summary,
                parameters=parameters,
                record=renamed(each.record),
            )
        )
    return tuple(changed)
