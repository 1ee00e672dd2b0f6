"""The Metal shading language."""

from programs.languages.c_family import CPP_WORDS, SELECTION, SHADING
from programs.languages.c_names import C_LIBRARY, C_MACROS
from programs.languages.shading_names import METAL_LIBRARY, METAL_WORDS
from programs.languages.spelling import Language, spell, typed_triples, words

_FUNCTIONS = spell(
    {
        operation: f"metal::{name}"
        for operation, name in (SHADING | {"atan2": "atan2", "rsqrt": "rsqrt"}).items()
    }
    | SELECTION
)

LANGUAGE = Language(
    key="metal",
    name="Metal",
    extension="metal",
    types={"half": "half", "float": "float"},
    literals={"half": "{}h", "float": "{}f"},
    functions={"half": _FUNCTIONS, "float": _FUNCTIONS},
    reserved=CPP_WORDS
    | C_MACROS
    | METAL_WORDS
    | words(
        "device constant thread threadgroup threadgroup_imageblock kernel vertex fragment metal",
        "half half2 half3 half4 float2 float3 float4 uint uchar ushort ulong sampler texture2d",
        "array vec access ray_data object_data",
    ),
    library=C_LIBRARY | METAL_LIBRARY,
    clamps=dict.fromkeys(
        ("half", "float"), ("metal::clamp({0}, {1}, {2})", "metal::saturate({0})")
    ),
    scalar_head="inline {type} {function}({arguments})",
    array_head="inline void {function}({arguments})",
    vectors={"half": "half4", "float": "float4"},
    triples=typed_triples({"half": "half3", "float": "float3"}),
    namespaces=True,
    prologue={precision: ("#include <metal_stdlib>",) for precision in ("half", "float")},
    array_argument="thread const {type} (&{name})[{size}]",
    array_result="thread {type} (&{name})[{size}]",
    # In Metal, a static constant inside a function would need an address space.
    table_opening="const {type} {name}[{size}] = {{",
)
