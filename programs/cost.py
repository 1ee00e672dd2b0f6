"""What a function costs: its operations, by kind."""

from collections import Counter
from collections.abc import Collection
from dataclasses import dataclass, fields

from programs.operations import OPERATIONS
from programs.program import Program, is_value

# What an operation of each kind weighs against an addition: a rule of thumb for graphics hardware,
# where reciprocals, roots and transcendental functions run at a quarter of the rate, a division is
# a reciprocal and a product, a function is one such instruction with its scaling, and a sign is
# part of the operation that takes it.
WEIGHTS = {"add": 1, "mul": 1, "div": 5, "sqrt": 4, "transcendental": 8, "select": 1, "sign": 0}


@dataclass(frozen=True)
class Cost:
    """Operations by kind.

    `add` counts additions and subtractions, `select` comparisons, selections, minima, maxima and
    roundings to whole numbers, `sign` negations and absolute values. `fma` counts the additions
    that could take up a product that nothing else uses: they are counted under `add` and `mul` too.
    """

    add: int = 0
    mul: int = 0
    div: int = 0
    sqrt: int = 0
    transcendental: int = 0
    select: int = 0
    sign: int = 0
    fma: int = 0

    @property
    def operations(self) -> int:
        """All operations but signs, each counted once."""
        return sum(getattr(self, kind) for kind in WEIGHTS if kind != "sign")

    @property
    def weighted(self) -> int:
        """All operations, each with its entry in WEIGHTS."""
        return sum(weight * getattr(self, kind) for kind, weight in WEIGHTS.items())


def count(program: Program, varying: Collection[str] | None = None) -> Cost:
    """Count the operations of a program.

    Arguments: `program`; `varying`, names of inputs (`alpha`; `c` for all of an array `c[0]`, …):
    only operations that depend on one of them are counted, as those of a material are not when
    they are done once for many directions. Returns the counts. Raises ValueError for a name that
    is no input.
    """
    changing = _changing(program, varying)
    uses = Counter(o for step in program.steps for o in step.operands if is_value(o))
    uses.update(o for o in program.outputs if is_value(o))
    first = len(program.inputs)
    products = {
        value
        for value, step in enumerate(program.steps, start=first)
        if step.operation == "mul" and uses[value] == 1
    }
    kinds: Counter[str] = Counter()
    for value, step in enumerate(program.steps, start=first):
        if value not in changing:
            continue
        kinds[OPERATIONS[step.operation].kind] += 1
        operands = {operand for operand in step.operands if is_value(operand)}
        if step.operation in ("add", "sub") and not products.isdisjoint(operands):
            kinds["fma"] += 1
    return Cost(**{field.name: kinds[field.name] for field in fields(Cost)})


def _changing(program: Program, varying: Collection[str] | None) -> set[int]:
    if varying is None:
        return set(range(len(program.inputs) + len(program.steps)))
    arrays = [name.partition("[")[0] for name in program.inputs]
    for name in varying:
        if name not in arrays and name not in program.inputs:
            allowed = ", ".join(dict.fromkeys(arrays))
            raise ValueError(f"{name!r} is no input of {program.name}; allowed: {allowed}")
    changing = {
        number
        for number, (name, array) in enumerate(zip(program.inputs, arrays, strict=True))
        if name in varying or array in varying
    }
    for value, step in enumerate(program.steps, start=len(program.inputs)):
        if not changing.isdisjoint(o for o in step.operands if is_value(o)):
            changing.add(value)
    return changing
