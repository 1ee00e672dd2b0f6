"""JavaScript. All its numbers are doubles."""

from programs.languages.c_family import MATH, SELECTION
from programs.languages.script_names import JAVASCRIPT_LIBRARY
from programs.languages.spelling import Language, Precedence, Spelling, spell, words

_NAMES = {operation: f"Math.{name}" for operation, name in MATH.items()} | {
    "abs": "Math.abs",
    "min": "Math.min",
    "max": "Math.max",
}
_OTHERS = {
    "exp2": Spelling("Math.pow(2.0, {0})"),
    "rsqrt": Spelling("1.0 / Math.sqrt({0})", Precedence.PRODUCT),
    "eq": Spelling("{0} === {1}", Precedence.EQUALITY),
    "ne": Spelling("{0} !== {1}", Precedence.EQUALITY),
}

LANGUAGE = Language(
    key="javascript",
    name="JavaScript",
    extension="js",
    types={"double": ""},
    literals={"double": "{}"},
    functions={"double": spell({**_NAMES, **_OTHERS, **SELECTION})},
    reserved=words(
        "abstract arguments await boolean break byte case catch char class const continue debugger",
        "default delete do double else enum eval export extends false final finally float for",
        "function goto if implements import in instanceof int interface let long native new null",
        "package private protected public return short static super switch synchronized this throw",
        "throws transient true try typeof undefined var void volatile while with yield Math NaN",
        "Infinity",
    ),
    library=JAVASCRIPT_LIBRARY,
    record_opening=None,
    preprocessor=False,
    prologue={"double": ()},
    scalar_argument="{name}",
    array_argument="{name}",
    array_result="",
    scalar_head="function {function}({arguments})",
    array_head="function {function}({arguments})",
    local_variable="const {name} = {value};",
    return_all="return [{values}];",
    return_three="[{values}]",
    table_opening="const {name} = [",
    table_closing="];",
)
