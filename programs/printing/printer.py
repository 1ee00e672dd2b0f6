"""Shader code from JAX functions: one expression, printed in any of the targets."""

import re
from collections.abc import Mapping, Sequence

from programs.function import Function, Parameter, input_names
from programs.languages import Target, target
from programs.operations import OPERATIONS
from programs.printing.expression import (
    ConstantPool,
    Wording,
    computation,
    literal,
    lone_expression,
)
from programs.printing.identifiers import ascii_text, free_name
from programs.printing.line_breaking import STEP, Break, Tokens, deeper, lay_out, wrap_words
from programs.printing.statement_choice import choose_statements
from programs.tracing.tracer import trace


def write(
    functions: Function | Sequence[Function],
    language: str | Target,
    precision: str = "float",
    *,
    constants: str = "inline",
    header: Mapping[str, str] | None = None,
) -> str:
    """Write functions as source code of a language, ready to paste.

    Arguments: `functions`, one or several; `language`, a key of TARGETS or a target; `precision`,
    "half", "float" or "double"; `constants`, "inline" or in a "table" at the head of each body;
    `header`, labels and texts for the comment that the source begins with, in order. Returns the
    source; the same call gives the same bytes. Raises ValueError for an unknown language, a
    precision that it has not, a name that it does not allow, an operation that it cannot express,
    a constant out of range, or a program too long for it.
    """
    spelled = target(language) if isinstance(language, str) else language
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
    function: Function, target: Target, precision: str, constants: str, taken: set[str]
) -> list[str]:
    program = trace(function)
    if len(program.steps) > target.limit:
        raise ValueError(
            f"{function.name} takes {len(program.steps)} operations; "
            f"allowed in {target.name}: at most {target.limit}"
        )
    statements = choose_statements(program, input_names(function), target, precision, taken)
    taken = taken | set(statements.names.values())
    pool = ConstantPool(free_name("coefficients", taken)) if constants == "table" else None
    wording = Wording(program, target, precision, statements.names, pool)
    kind = target.types[precision]

    body = []
    for value in statements.values:
        operation = program.steps[value - len(program.inputs)].operation
        body += _statement(
            target,
            target.local,
            computation(wording, value),
            type=target.boolean if OPERATIONS[operation].gives == "bool" else kind,
            name=statements.names[value],
        )
    body += _results(function, wording)

    lines = _function_comment(function, target)
    lines += lay_out(_signature(function, target, kind), "")
    lines += [target.opening] if target.opening is not None else []
    lines += _receive(function, target, kind)
    lines += _write_pool(wording, pool) if pool is not None and pool.places else []
    lines += body
    return lines + ([target.closing] if target.closing is not None else [])


def _results(function: Function, wording: Wording) -> list[str]:
    target, outputs = wording.target, wording.program.outputs
    values = [lone_expression(wording, output) for output in outputs]
    if function.result is None:
        return _statement(target, target.give, values[0])
    lines = []
    if target.several is None:
        for index, value in enumerate(values):
            names = {"name": function.result_name, "index": str(index)}
            lines += _statement(target, target.store, value, **names)
        return lines
    together: Tokens = list(deeper(values[0]))
    for value in values[1:]:
        together += [",", Break(), *deeper(value)]
    if len(values) == 1:
        together.append(",")
    opening, closing = target.several.split("{values}")
    return lay_out([opening, *together, closing], STEP)


def _statement(target: Target, template: str, value: Tokens, **parts: str) -> list[str]:
    before, after = template.split("{value}")
    before, after = before.format(**parts), after.format(**parts)
    lines = lay_out([before, *value, after], STEP)
    if len(lines) > 1 and target.bracketed:
        lines = lay_out([before, "(", *value, ")", after], STEP)
    return lines


def _signature(function: Function, target: Target, kind: str) -> Tokens:
    arguments = [_argument(target, parameter, kind) for parameter in function.parameters]
    head = target.head_one
    if function.result is not None:
        head = target.head_many
        if target.array_out:
            names = {"type": kind, "name": function.result_name, "size": function.result}
            arguments.append(target.array_out.format(**names))
    before, after = head.split("{arguments}")
    tokens: Tokens = [before.format(type=kind, function=function.name)]
    for index, argument in enumerate(arguments):
        tokens += [",", Break(), argument] if index else [argument]
    return [*tokens, after.format(type=kind)]


def _argument(target: Target, parameter: Parameter, kind: str) -> str:
    template = target.scalar_in if parameter.size is None else target.array_in
    return template.format(type=kind, name=parameter.name, size=parameter.size)


def _receive(function: Function, target: Target, kind: str) -> list[str]:
    lines = []
    for parameter in function.parameters:
        template = target.receive_scalar if parameter.size is None else target.receive_array
        if template is not None:
            lines.append(STEP + template.format(name=parameter.name, type=kind))
    return lines


def _write_pool(wording: Wording, pool: ConstantPool) -> list[str]:
    target = wording.target
    parts = {"type": target.types[wording.precision], "name": pool.name}
    tokens: Tokens = []
    for index, constant in enumerate(pool.places):
        tokens += [",", Break()] if index else []
        tokens.append(literal(wording, constant))
    if len(pool.places) == 1 and target.bracketed:
        tokens.append(",")
    opening = target.table_opening.format(**parts, size=len(pool.places))
    rows = lay_out(tokens, STEP * 2, STEP * 2)
    return [STEP + opening, *rows, STEP + target.table_closing.format()]


def _header_comment(target: Target, header: Mapping[str, str]) -> list[str]:
    lines = []
    for label, text in header.items():
        lines += _comment(target, f"{label}: {text}")
    return lines


def _function_comment(function: Function, target: Target) -> list[str]:
    domains = []
    for parameter in function.parameters:
        if parameter.size is not None:
            # Another function's result: its domain is a rough one, of samples.
            continue
        low, high = (f"{bound:.6g}" for bound in parameter.domain)
        unit = "" if parameter.unit == "1" else f" {parameter.unit}"
        domains.append(f"{parameter.name} in [{low}, {high}]{unit}")
    lines = _comment(target, function.summary)
    return lines + (_comment(target, ", ".join(domains) + ".") if domains else [])


def _comment(target: Target, text: str) -> list[str]:
    # A backslash at the end of a line would take the next line of code into the comment.
    safe = ascii_text(text).replace("\\", "/")
    return wrap_words(safe, f"{target.comment} ", f"{target.comment}   ")


def _taken_names(
    target: Target, precision: str, function: Function, functions: Sequence[str]
) -> set[str]:
    """Collect the names that no local may have; refuse the user's names that are not allowed."""
    called = {
        word
        for how in target.functions[precision].values()
        for word in re.findall(r"[A-Za-z_]\w*", how.template)
    }
    own = [parameter.name for parameter in function.parameters]
    if function.result is not None:
        own.append(function.result_name)
    for name in [function.name, *own]:
        unfit = name in target.reserved or name in called
        if unfit or "__" in name or name.startswith(("_", "gl_")):
            raise ValueError(
                f"name {name!r} cannot be used in {target.name}; allowed: identifiers that are no "
                "reserved word or function, without '_' in front, '__' or 'gl_'"
            )
    for name in own:
        if name in functions:
            raise ValueError(f"name {name!r} is a function and a parameter; allowed: one of them")
    return {*target.reserved, *called, *own, *functions}
