"""C, from C99 on; half precision is the _Float16 of gcc and clang."""

from programs.languages.c_family import (
    C_WORDS,
    COMPARED,
    MATH,
    SELECTION,
    reciprocal_root,
    suffixed,
)
from programs.languages.c_names import C_LIBRARY, C_MACROS
from programs.languages.spelling import Language, Precedence, Spelling, spell
from programs.precision import PRECISIONS

_FLOAT = spell(suffixed(MATH, "f") | reciprocal_root("1.0f", "sqrtf") | SELECTION | COMPARED)
_DOUBLE = spell(MATH | reciprocal_root("1.0", "sqrt") | SELECTION | COMPARED)

# C has no functions of half precision: compute in float and round.
_HALF = {
    operation: Spelling(f"(_Float16)({how.template})", Precedence.SIGN)
    for operation, how in _FLOAT.items()
} | spell(SELECTION | COMPARED)

LANGUAGE = Language(
    key="c",
    name="C",
    extension="c",
    types={"half": "_Float16", "float": "float", "double": "double"},
    literals={"half": "(_Float16){}f", "float": "{}f", "double": "{}"},
    functions={"half": _HALF, "float": _FLOAT, "double": _DOUBLE},
    reserved=C_WORDS | C_MACROS,
    library=C_LIBRARY,
    scalar_head="static inline {type} {function}({arguments})",
    array_head="static inline void {function}({arguments})",
    record_opening="typedef struct {name} {{",
    record_closing="}} {name};",
    prologue=dict.fromkeys(PRECISIONS, ("#include <math.h>",)),
    boolean="int",
    array_argument="const {type} {name}[{size}]",
)
