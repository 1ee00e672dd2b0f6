"""C++, from C++11 on; half precision is the _Float16 of gcc and clang."""

from programs.languages.c_family import (
    COMPARED,
    CPP_WORDS,
    MATH,
    SELECTION,
    reciprocal_root,
)
from programs.languages.c_names import C_MACROS, CPP_LIBRARY
from programs.languages.spelling import Language, Spelling, spell
from programs.precision import PRECISIONS

_STANDARD = {operation: f"std::{name}" for operation, name in MATH.items()} | {"abs": "std::abs"}
_FLOAT = spell(_STANDARD | reciprocal_root("1.0f", "std::sqrt") | SELECTION | COMPARED)
_DOUBLE = spell(_STANDARD | reciprocal_root("1.0", "std::sqrt") | SELECTION | COMPARED)

# A call of a <cmath> function is ambiguous for half precision: compute in float and round.
_HALF = {
    operation: Spelling(
        "_Float16(" + how.template.replace("{0}", "float({0})").replace("{1}", "float({1})") + ")"
    )
    for operation, how in _FLOAT.items()
} | spell(SELECTION | COMPARED)

LANGUAGE = Language(
    key="cpp",
    name="C++",
    extension="cpp",
    types={"half": "_Float16", "float": "float", "double": "double"},
    literals={"half": "_Float16({}f)", "float": "{}f", "double": "{}"},
    functions={"half": _HALF, "float": _FLOAT, "double": _DOUBLE},
    reserved=CPP_WORDS | C_MACROS,
    library=CPP_LIBRARY,
    scalar_head="inline {type} {function}({arguments})",
    array_head="inline void {function}({arguments})",
    namespaces=True,
    prologue=dict.fromkeys(PRECISIONS, ("#include <cmath>",)),
    array_argument="const {type} (&{name})[{size}]",
    array_result="{type} (&{name})[{size}]",
)
