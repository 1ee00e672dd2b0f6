"""HLSL, shader model 6. Half has 16 bits only with the flag -enable-16bit-types."""

from programs.languages.c_family import C_WORDS, SELECTION, SHADING
from programs.languages.shading_names import HLSL_LIBRARY, HLSL_WORDS
from programs.languages.spelling import Language, spell, typed_triples, words
from programs.precision import PRECISIONS

FUNCTIONS = spell(SHADING | {"atan2": "atan2", "rsqrt": "rsqrt"} | SELECTION)

# HLSL has no other intrinsic functions of doubles.
DOUBLE = {operation: FUNCTIONS[operation] for operation in ("abs", "min", "max", "select")}

WORDS = (
    C_WORDS
    | HLSL_WORDS
    | words(
        "AppendStructuredBuffer BlendState Buffer ByteAddressBuffer cbuffer centroid class",
        "column_major compile ComputeShader ConsumeStructuredBuffer DepthStencilState discard",
        "DomainShader dword export fxgroup GeometryShader groupshared half Hullshader in inout",
        "InputPatch interface line lineadj linear LineStream matrix min10float min12int min16float",
        "min16int min16uint namespace nointerpolation noperspective NULL out OutputPatch",
        "packoffset pass pixelfragment PixelShader point PointStream precise RasterizerState",
        "RenderTargetView row_major RWBuffer RWByteAddressBuffer RWStructuredBuffer sample sampler",
        "SamplerState snorm stateblock string StructuredBuffer tbuffer technique texture Texture1D",
        "Texture2D Texture3D TextureCube triangle triangleadj TriangleStream uint uniform unorm",
        "unsigned vector vertexfragment VertexShader float2 float3 float4 half2 half3 half4",
        "double2 double3 double4 int2 int3 int4 template this float16_t float32_t float64_t",
        "typename using virtual operator",
    )
)

LANGUAGE = Language(
    key="hlsl",
    name="HLSL",
    extension="hlsl",
    types={"half": "half", "float": "float", "double": "double"},
    literals={"half": "{}h", "float": "{}f", "double": "{}L"},
    functions={"half": FUNCTIONS, "float": FUNCTIONS, "double": DOUBLE},
    reserved=WORDS,
    library=HLSL_LIBRARY,
    clamps=dict.fromkeys(("half", "float"), ("clamp({0}, {1}, {2})", "saturate({0})")),
    vectors={"half": "half4", "float": "float4", "double": "double4"},
    triples=typed_triples({"half": "half3", "float": "float3", "double": "double3"}),
    namespaces=True,
    prologue=dict.fromkeys(PRECISIONS, ()),
    array_argument="in {type} {name}[{size}]",
    array_result="out {type} {name}[{size}]",
)
