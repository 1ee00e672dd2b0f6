"""The cost of a function: the number of its operations, by kind."""

from collections import Counter
from collections.abc import Collection
from dataclasses import dataclass, fields

from programs.operations import OPERATIONS
from programs.program import Program, is_value

# The kinds of operations, in the order of reports, and the cost of each in additions. It is a rule
# of thumb for graphics hardware: reciprocals, roots and transcendental functions run at a quarter
# of the rate of an addition; a division is a reciprocal and a product; a transcendental function
# needs a second such instruction to scale its argument; a sign costs nothing, since it is part of
# the instruction that uses the value.
WEIGHTS = {"add": 1, "mul": 1, "div": 5, "sqrt": 4, "transcendental": 8, "select": 1, "sign": 0}
KINDS = tuple(WEIGHTS)


@dataclass(frozen=True)
class Cost:
    """The number of operations of each kind; the fields are those of KINDS, and `fma`.

    `add` counts additions and subtractions; `select` counts comparisons, selections, minima, maxima
    and roundings to whole numbers; `sign` counts negations and absolute values. `fma` counts the
    additions that could be fused with a product that nothing else uses. Such an addition and its
    product are counted under `add` and `mul` too.
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
        """The number of all operations except signs."""
        return sum(getattr(self, kind) for kind in KINDS if kind != "sign")

    @property
    def weighted(self) -> int:
        """The sum of all operations, each multiplied by its entry in WEIGHTS."""
        return sum(weight * getattr(self, kind) for kind, weight in WEIGHTS.items())


def count_operations(program: Program, varying: Collection[str] | None = None) -> Cost:
    """Count the operations of a program by kind.

    Arguments: `program`; `varying`, names of inputs (`x`, or `c` for a whole array `c[0]`, …), or
    None for all. Only operations that depend on one of these inputs are counted, because the others
    can be done once for many evaluations. Returns the counts. Raises ValueError for a name that is
    not an input.
    """
    changing = _varying_values(program, varying)
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


def _varying_values(program: Program, varying: Collection[str] | None) -> set[int]:
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
