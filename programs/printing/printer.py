"""Printing functions as source code: any JAX function of scalars, in any of the languages."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from programs.functions import Function, Parameter
from programs.languages import Language
from programs.languages import language as find_language
from programs.operations import OPERATIONS
from programs.printing.allowed_names import require_namespace, taken_names
from programs.printing.comments import function_comment, header_comment
from programs.printing.expression import (
    ConstantPool,
    WritingContext,
    computation,
    literal,
    typed_expression,
)
from programs.printing.identifiers import free_name
from programs.printing.line_breaking import INDENT, Break, Tokens, break_lines, nested
from programs.printing.lowering import lowered
from programs.printing.records import (
    empty_components,
    in_threes,
    record_declarations,
    record_of,
)
from programs.printing.statement_choice import choose_statements
from programs.tracing.tracer import trace

# Stores one of several results in a structure.
_STORE = "{place} = {value};"


@dataclass(frozen=True)
class Section:
    """Functions, and the labels and texts of the comment above them, in order."""

    functions: tuple[Function, ...]
    header: Mapping[str, str]


def write_source(
    functions: Function | Sequence[Function],
    language: str | Language,
    precision: str = "float",
    *,
    constants: str = "inline",
    header: Mapping[str, str] | None = None,
) -> str:
    """Write functions as source code that can be pasted into a shader.

    Arguments: `functions`, one or several; `language`, a key of LANGUAGES or a `Language`;
    `precision`, a key of PRECISIONS; `constants`, "inline", or "table" for an array at the start of
    each body; `header`, labels and texts for a comment at the start of the source, in order.
    Returns the source; the same call returns the same bytes. Raises ValueError for an unknown
    language, a precision that it does not have, a name that it does not allow, an operation that it
    cannot express, a constant out of range, and a program that is too long for it.
    """
    chosen = (functions,) if isinstance(functions, Function) else tuple(functions)
    section = Section(chosen, header or {})
    return write_sections([section], language, precision, constants=constants)


def write_sections(
    sections: Sequence[Section],
    language: str | Language,
    precision: str = "float",
    *,
    constants: str = "inline",
    guard: str | None = None,
    namespace: str | None = None,
    ending: Sequence[list[str]] = (),
) -> str:
    """Write groups of functions as one source file, each group under a header of its own.

    Arguments: `sections`; `guard`, the name of an include guard, which a language without a
    preprocessor ignores; `namespace`, that of all functions; `ending`, blocks of lines
    after the functions; the rest as in `write_source`. Returns
    the source. Raises ValueError as `write_source` does, and for a namespace in a language without.
    """
    spelled = find_language(language) if isinstance(language, str) else language
    chosen = [function for section in sections for function in section.functions]
    if precision not in spelled.types:
        raise ValueError(
            f"precision {precision!r} is not in {spelled.name}; allowed: {', '.join(spelled.types)}"
        )
    if constants not in ("inline", "table"):
        raise ValueError(f"constants {constants!r} is unknown; allowed: inline, table")
    names = [function.name for function in chosen]
    for name in names:
        if names.count(name) > 1:
            raise ValueError(f"function name {name!r} occurs twice; allowed: once")
    if namespace is not None:
        require_namespace(spelled, namespace)
    blocks = [header_comment(spelled, sections[0].header)] if sections[0].header else []
    guarded = guard is not None and spelled.preprocessor
    blocks += [[f"#ifndef {guard}", f"#define {guard}"]] if guarded else []
    blocks += [list(spelled.prologue[precision])] if spelled.prologue[precision] else []
    blocks += [[f"namespace {namespace} {{"]] if namespace is not None else []
    records = record_declarations(spelled, precision, chosen)
    for section in sections:
        if section is not sections[0] and section.header:
            blocks.append(header_comment(spelled, section.header))
        own = record_declarations(spelled, precision, section.functions)
        blocks += [record for record in own if record in records]
        records = [record for record in records if record not in own]
        for function in section.functions:
            taken = taken_names(spelled, precision, function, names, ending)
            blocks.append(_function(function, spelled, precision, constants, taken))
    blocks += ending
    blocks += [[f"}} {spelled.comment} namespace {namespace}"]] if namespace is not None else []
    blocks += [[f"#endif {spelled.comment} {guard}"]] if guarded else []
    return "\n\n".join("\n".join(block) for block in blocks) + "\n"


def _function(
    function: Function, language: Language, precision: str, constants: str, taken: set[str]
) -> list[str]:
    program = lowered(trace(function), language.functions[precision])
    if len(program.steps) > language.max_operations:
        raise ValueError(
            f"{function.name} takes {len(program.steps)} operations; "
            f"allowed in {language.name}: at most {language.max_operations}"
        )
    statements = choose_statements(
        program, _written_inputs(function, language, precision), language, precision, taken
    )
    taken = taken | set(statements.names.values())
    pool = ConstantPool(free_name("coefficients", taken)) if constants == "table" else None
    context = WritingContext(program, language, precision, statements.names, pool)
    kind = language.types[precision]

    body = []
    for value in statements.values:
        operation = program.steps[value - len(program.inputs)].operation
        body += _statement(
            language,
            language.local_variable,
            computation(context, value),
            type=language.boolean if OPERATIONS[operation].gives == "bool" else kind,
            name=statements.names[value],
        )
    body += _results(function, context)

    lines = function_comment(function, language)
    lines += break_lines(_signature(function, language, precision), "")
    lines += [language.body_opening] if language.body_opening is not None else []
    lines += _convert_arguments(function, language, kind)
    lines += _pool_declaration(context, pool) if pool is not None and pool.places else []
    lines += body
    return lines + ([language.body_closing] if language.body_closing is not None else [])


def _results(function: Function, context: WritingContext) -> list[str]:
    language, outputs = context.language, context.program.outputs
    values = [typed_expression(context, output) for output in outputs]
    if function.result is None:
        return _statement(language, language.return_statement, values[0])
    lines = []
    record = record_of(language, function)
    if record is not None:
        component, name = language.triple(context.precision).component, function.result_name
        lines.append(INDENT + language.record_variable.format(type=record.name, name=name))
        for index, value in enumerate(values):
            place = f"{name}.{record.place(index, component)}"
            lines += _statement(language, _STORE, value, place=place)
        for place in empty_components(record, len(values)):
            zero: Tokens = [literal(context, 0.0)]
            lines += _statement(language, _STORE, zero, place=f"{name}.{place}")
        return lines + _statement(language, language.return_statement, [name])
    if language.return_all is None:
        for index, value in enumerate(values):
            names = {"name": function.result_name, "index": str(index)}
            lines += _statement(language, language.store_statement, value, **names)
        return lines
    if function.record is not None and function.record.vectors:
        values = in_threes(values, language)
    together: Tokens = list(nested(values[0]))
    for value in values[1:]:
        together += [",", Break(), *nested(value)]
    if len(values) == 1:
        together.append(",")
    opening, closing = language.return_all.split("{values}")
    return break_lines([opening, *together, closing], INDENT)


def _statement(language: Language, template: str, value: Tokens, **parts: str) -> list[str]:
    before, after = template.split("{value}")
    before, after = before.format(**parts), after.format(**parts)
    lines = break_lines([before, *value, after], INDENT)
    if len(lines) > 1 and language.parenthesize_lines:
        lines = break_lines([before, "(", *value, ")", after], INDENT)
    return lines


def _signature(function: Function, language: Language, precision: str) -> Tokens:
    kind = language.types[precision]
    arguments = [_argument(language, parameter, precision) for parameter in function.parameters]
    head = language.scalar_head
    record = record_of(language, function)
    if record is not None:
        kind = record.name
    elif function.result is not None:
        head = language.array_head
        if language.array_result:
            names = {"type": kind, "name": function.result_name, "size": function.result}
            arguments.append(language.array_result.format(**names))
    before, after = head.split("{arguments}")
    tokens: Tokens = [before.format(type=kind, function=function.name)]
    for index, argument in enumerate(arguments):
        tokens += [",", Break(), argument] if index else [argument]
    return [*tokens, after.format(type=kind)]


def _argument(language: Language, parameter: Parameter, precision: str) -> str:
    kind, record = language.types[precision], record_of(language, parameter)
    if record is not None:
        return language.scalar_argument.format(type=record.name, name=parameter.name)
    size = None if parameter.size is None else str(parameter.size)
    if parameter.size is not None and parameter.shape != "array":
        count = parameter.size // 3 if parameter.shape == "vectors" else None
        kind, size = language.triple(precision).type_and_extent(kind, count)
    template = language.scalar_argument if size is None else language.array_argument
    return template.format(type=kind, name=parameter.name, size=size)


def _written_inputs(function: Function, language: Language, precision: str) -> tuple[str, ...]:
    """Return how each number of a function's input is written in code."""
    names = []
    for parameter in function.parameters:
        record = record_of(language, parameter)
        if record is None or parameter.size is None:
            names += parameter.places(language.triple(precision).component)
        else:
            names += [f"{parameter.name}.{record.place(k)}" for k in range(parameter.size)]
    return tuple(names)


def _convert_arguments(function: Function, language: Language, kind: str) -> list[str]:
    lines = []
    for parameter in function.parameters:
        template = (
            language.scalar_conversion if parameter.size is None else language.array_conversion
        )
        if parameter.shape == "vectors":
            template = language.vectors_conversion
        if template is not None:
            lines.append(INDENT + template.format(name=parameter.name, type=kind))
    return lines


def _pool_declaration(context: WritingContext, pool: ConstantPool) -> list[str]:
    language = context.language
    parts = {"type": language.types[context.precision], "name": pool.name}
    tokens: Tokens = []
    for index, constant in enumerate(pool.places):
        tokens += [",", Break()] if index else []
        tokens.append(literal(context, constant))
    if len(pool.places) == 1 and language.parenthesize_lines:
        tokens.append(",")
    opening = language.table_opening.format(**parts, size=len(pool.places))
    rows = break_lines(tokens, INDENT * 2, INDENT * 2)
    return [INDENT + opening, *rows, INDENT + language.table_closing.format()]
