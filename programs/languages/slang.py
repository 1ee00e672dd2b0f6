"""Slang, which is spelled as HLSL is, but has a few more functions of doubles."""

from dataclasses import replace

from programs.languages.hlsl import FUNCTIONS, WORDS
from programs.languages.hlsl import LANGUAGE as HLSL
from programs.languages.shading_names import SLANG_LIBRARY
from programs.languages.spelling import words

# Slang compiles more functions of doubles, but to code without meaning: compiled to SPIR-V, the
# sine of a double was measured to be NaN.
_DOUBLE = {
    operation: FUNCTIONS[operation]
    for operation in ("abs", "sqrt", "rsqrt", "min", "max", "floor", "ceil", "select")
}

LANGUAGE = replace(
    HLSL,
    key="slang",
    name="Slang",
    extension="slang",
    functions={"half": FUNCTIONS, "float": FUNCTIONS, "double": _DOUBLE},
    reserved=WORDS
    | words("__generic __init associatedtype extension func import let module property var where"),
    library=SLANG_LIBRARY,
)
