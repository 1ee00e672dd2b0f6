"""GLSL 4.00 and ESSL 3.00. Half precision needs an extension; double has few functions."""

from programs.languages.c_family import C_WORDS, SELECTION, SHADING
from programs.languages.shading_names import GLSL_LIBRARY, GLSL_WORDS
from programs.languages.spelling import Language, Spelling, spell, typed_triples, words

_FUNCTIONS = spell(
    SHADING | {"rsqrt": "inversesqrt", "atan2": Spelling("atan({0}, {1})")} | SELECTION
)
_DOUBLE = {
    operation: _FUNCTIONS[operation]
    for operation in ("abs", "sqrt", "rsqrt", "min", "max", "floor", "ceil", "select")
}

LANGUAGE = Language(
    key="glsl",
    name="GLSL",
    extension="glsl",
    types={"half": "float16_t", "float": "float", "double": "double"},
    literals={"half": "{}hf", "float": "{}", "double": "{}lf"},
    functions={"half": _FUNCTIONS, "float": _FUNCTIONS, "double": _DOUBLE},
    reserved=C_WORDS
    | GLSL_WORDS
    | words(
        "attribute uniform buffer shared coherent readonly writeonly layout centroid flat smooth",
        "noperspective patch sample invariant precise subroutine in out inout discard mat2 mat3",
        "mat4 vec2 vec3 vec4 ivec2 ivec3 ivec4 bvec2 bvec3 bvec4 uvec2 uvec3 uvec4 dvec2 dvec3",
        "dvec4 uint lowp mediump highp precision sampler1D sampler2D sampler3D samplerCube common",
        "partition active class this resource noinline public external interface half fixed input",
        "output filter superp hvec2 hvec3 hvec4 fvec2 fvec3 fvec4 template namespace using cast",
        "varying float16_t float32_t float64_t",
    ),
    library=GLSL_LIBRARY,
    clamps=dict.fromkeys(("half", "float"), ("clamp({0}, {1}, {2})", "clamp({0}, {1}, {2})")),
    vectors={"half": "f16vec4", "float": "vec4", "double": "dvec4"},
    triples=typed_triples({"half": "f16vec3", "float": "vec3", "double": "dvec3"}),
    prologue={
        "half": ("#extension GL_EXT_shader_explicit_arithmetic_types_float16 : require",),
        "float": (),
        "double": (),
    },
    array_argument="in {type} {name}[{size}]",
    array_result="out {type} {name}[{size}]",
    # Before GLSL 4.20, the value of a const variable must be a constant expression.
    local_variable="{type} {name} = {value};",
    table_opening="const {type} {name}[{size}] = {type}[{size}](",
    table_closing=");",
)
