"""CUDA C++: functions that can be called on the device and on the host."""

from programs.languages.c_family import CPP_WORDS, MATH, SELECTION, reciprocal_root, suffixed
from programs.languages.c_names import C_MACROS, CPP_LIBRARY
from programs.languages.shading_names import CUDA_LIBRARY, CUDA_WORDS
from programs.languages.spelling import Language, spell, typed_triples, words

# On the device, fminf is one instruction; the function exists on the host too.
_MATH = MATH | {"min": "fmin", "max": "fmax"}

LANGUAGE = Language(
    key="cuda",
    name="CUDA",
    extension="cu",
    types={"float": "float", "double": "double"},
    literals={"float": "{}f", "double": "{}"},
    functions={
        "float": spell(suffixed(_MATH, "f") | reciprocal_root("1.0f", "sqrtf") | SELECTION),
        "double": spell(_MATH | reciprocal_root("1.0", "sqrt") | SELECTION),
    },
    reserved=CPP_WORDS
    | C_MACROS
    | CUDA_WORDS
    | words(
        "__host__ __device__ __global__ __shared__ __constant__ threadIdx blockIdx blockDim",
        "gridDim warpSize half float2 float3 float4 double2 double3 double4 dim3",
    ),
    library=CPP_LIBRARY | CUDA_LIBRARY,
    vectors={"float": "float4"},
    triples=typed_triples({"float": "float3", "double": "double3"}),
    namespaces=True,
    prologue={precision: ("#include <math.h>",) for precision in ("float", "double")},
    array_argument="const {type} (&{name})[{size}]",
    array_result="{type} (&{name})[{size}]",
    scalar_head="__host__ __device__ inline {type} {function}({arguments})",
    array_head="__host__ __device__ inline void {function}({arguments})",
    table_opening="const {type} {name}[{size}] = {{",
)
