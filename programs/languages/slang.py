"""Slang: HLSL's spelling, with the roots of doubles too."""

from dataclasses import replace

from programs.languages.hlsl import FUNCTIONS, WORDS
from programs.languages.hlsl import LANGUAGE as HLSL
from programs.languages.spelling import words

# More functions of doubles compile, but on what Slang compiles to they have no meaning (measured:
# through SPIR-V, sin of a double is NaN).
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
)
