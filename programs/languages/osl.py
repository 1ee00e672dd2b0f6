"""The Open Shading Language. It has only floats, and no constant variables."""

from programs.languages.c_family import SELECTION, SHADING
from programs.languages.shading_names import OSL_LIBRARY, OSL_MACROS
from programs.languages.spelling import Language, spell, typed_triples, words

LANGUAGE = Language(
    key="osl",
    name="OSL",
    extension="osl",
    types={"float": "float"},
    literals={"float": "{}"},
    functions={
        "float": spell(
            SHADING | {"rsqrt": "inversesqrt", "atan2": "atan2", "expm1": "expm1"} | SELECTION
        )
    },
    reserved=OSL_MACROS
    | words(
        "and break closure color continue displacement do else emit float for if illuminance",
        "illuminate int matrix normal not or output point public return string struct surface",
        "shader vector void volume while bool case catch char class const delete default double",
        "enum extern false friend goto inline long new operator private protected short signed",
        "sizeof static switch template this throw true try typedef uniform union unsigned varying",
        "virtual P I N Ng u v dPdu dPdv Ps time dtime dPdtime Ci",
    ),
    library=OSL_LIBRARY,
    clamps=dict.fromkeys(("float",), ("clamp({0}, {1}, {2})", "clamp({0}, {1}, {2})")),
    prologue={"float": ()},
    boolean="int",
    array_result="output {type} {name}[{size}]",
    triples=typed_triples({"float": "vector"}, "{vector}[{index}]"),
    local_variable="{type} {name} = {value};",
    table_opening="{type} {name}[{size}] = {{",
)
