"""JavaScript: its only number is a double."""

from programs.languages.c_family import MATH, SELECTION
from programs.languages.language import Binding, Spelling, Target, spell, words

_NAMES = {operation: f"Math.{name}" for operation, name in MATH.items()} | {
    "abs": "Math.abs",
    "min": "Math.min",
    "max": "Math.max",
}
_OTHERS = {
    "exp2": Spelling("Math.pow(2.0, {0})"),
    "rsqrt": Spelling("1.0 / Math.sqrt({0})", Binding.PRODUCT),
    "eq": Spelling("{0} === {1}", Binding.EQUALITY),
    "ne": Spelling("{0} !== {1}", Binding.EQUALITY),
}

TARGET = Target(
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
    prologue={"double": ()},
    scalar_in="{name}",
    array_in="{name}",
    array_out="",
    head_one="function {function}({arguments})",
    head_many="function {function}({arguments})",
    local="const {name} = {value};",
    several="return [{values}];",
    table_opening="const {name} = [",
    table_closing="];",
)
