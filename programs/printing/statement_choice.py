"""Choosing which values of a program get a statement of their own, and their names."""

from collections import Counter
from collections.abc import Collection
from dataclasses import dataclass

from programs.languages import Language
from programs.printing.expression import spelling
from programs.printing.identifiers import (
    as_identifier,
    camel_case,
    descriptive_name,
    free_name,
)
from programs.program import Operand, Program, Step, is_value

# The largest number of operations in one expression: a longer one would be hard to read.
MAX_OPERATIONS = 48
# The largest number of calls that are nested in each other.
MAX_NESTED_CALLS = 4
# A value that is used once keeps its author's name if it takes at least this many operations.
MIN_OPERATIONS_TO_NAME = 3
# Operation -> the name of a result that neither the author nor its operands name
NOUNS: dict[str, str] = {
    operation: noun
    for noun, operations in {
        "sum": "add",
        "difference": "sub",
        "product": "mul",
        "quotient": "div",
        "power": "pow exp exp2 expm1",
        "logarithm": "log log1p",
        "root": "sqrt rsqrt",
        "limited": "min max",
        "rounded": "floor ceil",
        "chosen": "select",
        "holds": "lt le gt ge eq ne and or not",
        "magnitude": "abs",
        "negative": "neg",
        "angle": "asin acos atan atan2",
        "ratio": "sin cos tan sinh cosh tanh",
    }.items()
    for operation in operations.split()
}


@dataclass(frozen=True)
class Statements:
    """The values that have a statement, in order; and the names of these values and the inputs."""

    values: tuple[int, ...]
    names: dict[int, str]


def choose_statements(
    program: Program,
    input_texts: tuple[str, ...],
    language: Language,
    precision: str,
    taken: Collection[str],
) -> Statements:
    """Choose the values that get a statement and a name.

    They are the values that are used more than once, those whose expression would be too long, and
    those that the function's author named. Arguments: `input_texts`, how each input is written
    (`alpha`, `c[0]`); `taken`, names that cannot be used. Returns the statements. Raises ValueError
    for an operation that the language does not have.
    """
    first = len(program.inputs)
    uses = Counter(o for step in program.steps for o in step.operands if is_value(o))
    uses.update(o for o in program.outputs if is_value(o))
    repeated = _written_repeatedly(program, language, precision)
    names = dict(enumerate(input_texts))
    used = set(taken)
    sizes: dict[int, int] = {}
    depths: dict[int, int] = {}
    chosen = []
    for value, step in enumerate(program.steps, start=first):
        inner = [o for o in step.operands if is_value(o) and o not in names]
        sizes[value] = size = 1 + sum(sizes[o] for o in inner)
        is_call = spelling(language, precision, step.operation) is not None
        depths[value] = depth = is_call + max((depths[o] for o in inner), default=0)
        is_output = any(is_value(o) and o == value for o in program.outputs)
        # −x costs nothing, and reads better than a new name.
        bare_sign = step.operation == "neg" and size == 1
        selection = step.operation in ("min", "max", "select")
        authored = (
            step.hint is not None
            and not is_output
            and (selection or size >= MIN_OPERATIONS_TO_NAME)
        )
        too_much = size > MAX_OPERATIONS or depth > MAX_NESTED_CALLS
        if value in repeated or too_much or authored or (uses[value] > 1 and not bare_sign):
            wanted = _wanted_name(program, value, names) or repeated.get(value)
            names[value] = free_name(camel_case(wanted or NOUNS[step.operation]), used)
            used.add(names[value])
            chosen.append(value)
    return Statements(tuple(chosen), names)


def _written_repeatedly(
    program: Program, language: Language, precision: str
) -> dict[int, str | None]:
    """Find the values that the spelling of an operation writes more than once, with their names.

    For example, a minimum that is spelled as a comparison writes each operand twice.
    """
    found: dict[int, str | None] = {}
    for step in program.steps:
        how = spelling(language, precision, step.operation)
        if how is not None and how.atoms:
            name = as_identifier(step.hint or "")
            for operand in step.operands:
                if is_value(operand) and operand >= len(program.inputs):
                    found[operand] = f"{name}Raw" if name else None
    return found


def _wanted_name(program: Program, value: int, names: dict[int, str]) -> str | None:
    step = program.steps[value - len(program.inputs)]
    hint = camel_case(as_identifier(step.hint or ""))
    argument = _clamped_input(program, step)
    if argument is not None and hint in ("", argument):
        # After alpha = clip(alpha, …), the argument and the clamped value need different names.
        return f"{argument}Clamped"
    return hint or _description(program, value, names)


def _clamped_input(program: Program, step: Step) -> str | None:
    """Return the name of the input that a step clamps; None if it does not clamp an input.

    A clamp consists of a minimum and a maximum. If an author's hint has the name of an input, one
    of the two is enough.
    """
    first, hint = len(program.inputs), camel_case(as_identifier(step.hint or ""))
    if step.operation not in ("min", "max"):
        return None
    inner = step.operands[0]
    if not is_value(inner):
        return None
    if inner >= first and program.steps[inner - first].operation in ("min", "max"):
        inner = program.steps[inner - first].operands[0]
    elif hint not in program.inputs:
        return None
    return program.inputs[inner] if is_value(inner) and inner < first else None


def _description(program: Program, value: int, names: dict[int, str]) -> str | None:
    step = program.steps[value - len(program.inputs)]

    def name(operand: Operand) -> str | None:
        if not is_value(operand):
            return None
        if operand in names:
            return camel_case(as_identifier(names[operand]))
        # If only b·b·b uses b·b, then b·b has no statement. The name b3 is still made of b2 and b.
        inner = program.steps[operand - len(program.inputs)]
        return _description(program, operand, names) if inner.operation == "mul" else None

    return descriptive_name(step, tuple(map(name, step.operands)))
