"""WGSL, the shading language of WebGPU."""

from programs.languages.c_family import SHADING
from programs.languages.shading_names import WGSL_LIBRARY
from programs.languages.spelling import Language, Spelling, spell, typed_triples, words

_FUNCTIONS = spell(
    SHADING
    | {
        "rsqrt": "inverseSqrt",
        "atan2": "atan2",
        "select": Spelling("select({2}, {1}, {0})"),
    }
)

LANGUAGE = Language(
    key="wgsl",
    name="WGSL",
    extension="wgsl",
    types={"half": "f16", "float": "f32"},
    literals={"half": "{}h", "float": "{}f"},
    functions={"half": _FUNCTIONS, "float": _FUNCTIONS},
    reserved=words(
        "alias break case const const_assert continue continuing default diagnostic discard else",
        "enable false fn for if let loop override requires return struct switch true var while",
        "NULL Self abstract active alignas alignof as asm asm_fragment async attribute auto await",
        "become binding_array cast catch class co_await co_return co_yield coherent column_major",
        "common compile compile_fragment concept const_cast consteval constexpr constinit crate",
        "debugger decltype delete demote demote_to_helper do dynamic_cast enum explicit export",
        "extends extern external fallthrough filter final finally friend from fxgroup get goto",
        "groupshared highp impl implements import inline instanceof interface layout lowp macro",
        "macro_rules match mediump meta mod module move mut mutable namespace new nil noexcept",
        "noinline nointerpolation non_coherent noncoherent noperspective null nullptr of operator",
        "package packoffset partition pass patch pixelfragment precise precision premerge priv",
        "protected pub public readonly ref regardless register reinterpret_cast require resource",
        "restrict self set shared sizeof smooth snorm static static_assert static_cast std",
        "subroutine super target template this thread_local throw trait try type typedef typeid",
        "typename typeof union unless unorm unsafe unsized use using varying virtual volatile wgsl",
        "where with writeonly yield array atomic bool f16 f32 i32 u32 ptr vec2 vec3 vec4 mat2x2",
        "mat3x3 mat4x4 sampler _",
    ),
    library=WGSL_LIBRARY,
    clamps=dict.fromkeys(("half", "float"), ("clamp({0}, {1}, {2})", "saturate({0})")),
    vectors={"half": "vec4<f16>", "float": "vec4<f32>"},
    triples=typed_triples({"half": "vec3<f16>", "float": "vec3<f32>"}),
    record_number="{name}: {type},",
    record_array="{name}: array<{type}, {size}>,",
    record_closing="}}",
    record_variable="var {name}: {type};",
    preprocessor=False,
    prologue={"half": ("enable f16;",), "float": ()},
    scalar_argument="{name}: {type}",
    array_argument="{name}: array<{type}, {size}>",
    array_result="{name}: ptr<function, array<{type}, {size}>>",
    scalar_head="fn {function}({arguments}) -> {type}",
    array_head="fn {function}({arguments})",
    local_variable="let {name} = {value};",
    store_statement="(*{name})[{index}] = {value};",
    table_opening="const {name} = array<{type}, {size}>(",
    table_closing=");",
)
