"""A program as C code in interval arithmetic, for `kernel/jets.h`, by the project's own printer."""

import re
from pathlib import Path

from programs.languages.c_family import C_WORDS
from programs.languages.spelling import Language, Spelling
from programs.operations import OPERATIONS

# Every operand is a name or a number (`atoms`): the macros of the kernel write operands repeatedly.
_CALLS = {
    name: Spelling(
        f"{name.upper()}({', '.join(f'{{{k}}}' for k in range(operation.arity))})", atoms=True
    )
    for name, operation in OPERATIONS.items()
}
# The files of the kernel that come before a printed program, and the names that they define
FILES = tuple(Path(__file__).parent / "kernel" / name for name in ("jets.h", "elementary.h"))
_DEFINITION = re.compile(
    r"^#define (\w+)|^(?:INLINE|static)[\w ]* (\w+)\(|^typedef .* (\w+)[ ;]", re.M
)
_OWN = frozenset(
    name
    for file in FILES
    for found in _DEFINITION.findall(file.read_text("utf-8"))
    for name in found
    if name
) | {"K", "V", "M"}

# Values are jets and conditions truths. The boxes K, which note what is undefined, come first.
INTERVAL_C = Language(
    key="interval-c",
    name="C in interval arithmetic",
    extension="h",
    types={"double": "jet"},
    literals={"double": "{}"},
    functions={"double": _CALLS},
    reserved=_OWN | C_WORDS,
    library=frozenset(),
    prologue={"double": ()},
    boolean="truth",
    array_argument="const {type} *{name}",
    array_result="{type} *{name}",
    scalar_head="static {type} {function}(boxes *K, {arguments})",
    array_head="static void {function}(boxes *K, {arguments})",
    return_statement="return JET({value});",
    store_statement="{name}[{index}] = JET({value});",
)
