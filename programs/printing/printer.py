"""Printing functions as source code: any JAX function of scalars, in any of the languages."""

import re
from collections.abc import Mapping, Sequence

from programs.functions import Function, Parameter, input_names
from programs.languages import Language
from programs.languages import language as find_language
from programs.operations import OPERATIONS
from programs.printing.expression import (
    ConstantPool,
    WritingContext,
    computation,
    literal,
    typed_expression,
)
from programs.printing.identifiers import ascii_text, free_name
from programs.printing.line_breaking import INDENT, Break, Tokens, break_lines, nested, wrap_words
from programs.printing.lowering import lowered
from programs.printing.statement_choice import choose_statements
from programs.tracing.tracer import trace


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
    spelled = find_language(language) if isinstance(language, str) else language
    chosen = [functions] if isinstance(functions, Function) else list(functions)
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
    blocks = []
    if header:
        blocks.append(_header_comment(spelled, header))
    if spelled.prologue[precision]:
        blocks.append(list(spelled.prologue[precision]))
    for function in chosen:
        taken = _taken_names(spelled, precision, function, names)
        blocks.append(_function(function, spelled, precision, constants, taken))
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
    statements = choose_statements(program, input_names(function), language, precision, taken)
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

    lines = _function_comment(function, language)
    lines += break_lines(_signature(function, language, kind), "")
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
    if language.return_all is None:
        for index, value in enumerate(values):
            names = {"name": function.result_name, "index": str(index)}
            lines += _statement(language, language.store_statement, value, **names)
        return lines
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


def _signature(function: Function, language: Language, kind: str) -> Tokens:
    arguments = [_argument(language, parameter, kind) for parameter in function.parameters]
    head = language.scalar_head
    if function.result is not None:
        head = language.array_head
        if language.array_result:
            names = {"type": kind, "name": function.result_name, "size": function.result}
            arguments.append(language.array_result.format(**names))
    before, after = head.split("{arguments}")
    tokens: Tokens = [before.format(type=kind, function=function.name)]
    for index, argument in enumerate(arguments):
        tokens += [",", Break(), argument] if index else [argument]
    return [*tokens, after.format(type=kind)]


def _argument(language: Language, parameter: Parameter, kind: str) -> str:
    template = language.scalar_argument if parameter.size is None else language.array_argument
    return template.format(type=kind, name=parameter.name, size=parameter.size)


def _convert_arguments(function: Function, language: Language, kind: str) -> list[str]:
    lines = []
    for parameter in function.parameters:
        template = (
            language.scalar_conversion if parameter.size is None else language.array_conversion
        )
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


def _header_comment(language: Language, header: Mapping[str, str]) -> list[str]:
    lines = []
    for label, text in header.items():
        lines += _comment(language, f"{label}: {text}")
    return lines


def _function_comment(function: Function, language: Language) -> list[str]:
    domains = []
    for parameter in function.parameters:
        if parameter.size is not None:
            # An array holds another function's results; its domain is a rough estimate.
            continue
        low, high = (f"{bound:.6g}" for bound in parameter.domain)
        unit = "" if parameter.unit == "1" else f" {parameter.unit}"
        domains.append(f"{parameter.name} in [{low}, {high}]{unit}")
    lines = _comment(language, function.summary)
    return lines + (_comment(language, ", ".join(domains) + ".") if domains else [])


def _comment(language: Language, text: str) -> list[str]:
    # A backslash at the end of a line would make the next line of code part of the comment.
    safe = ascii_text(text).replace("\\", "/")
    return wrap_words(safe, f"{language.comment} ", f"{language.comment}   ")


def _taken_names(
    language: Language, precision: str, function: Function, functions: Sequence[str]
) -> set[str]:
    """Collect the names that local variables cannot have.

    Raises ValueError for a name of the function, its parameters or its result that the language
    does not allow.
    """
    called = {
        word
        for template in [
            *(how.template for how in language.functions[precision].values()),
            *language.clamps.get(precision, ()),
        ]
        for word in re.findall(r"[A-Za-z_]\w*", template)
    }
    own = [parameter.name for parameter in function.parameters]
    if function.result is not None:
        own.append(function.result_name)
    for name in [function.name, *own]:
        unfit = name in language.reserved or name in called
        if unfit or "__" in name or name.startswith(("_", "gl_")):
            raise ValueError(
                f"name {name!r} cannot be used in {language.name}; allowed: identifiers that are "
                "no reserved word or function, without '_' in front, '__' or 'gl_'"
            )
    for name in own:
        if name in functions:
            raise ValueError(f"name {name!r} is a function and a parameter; allowed: one of them")
    return {*language.reserved, *called, *own, *functions}
