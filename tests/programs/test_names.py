"""Names that exported code may have: those that a language or its library has are refused."""

import builtins
import re
import subprocess

import numpy as np
import pytest

from programs import LANGUAGES, Parameter, function, write_source
from programs.functions import Record
from programs.languages.c_family import C_WORDS
from programs.languages.c_names import C_LIBRARY, C_MACROS
from programs.languages.spelling import words
from programs.printing.printer import Section, write_sections
from programs.toolchains.process import missing_command
from tests.programs.toys import ready

UNIT = (0.25, 1.0)
# Names of functions, structures and namespaces that compilers refuse or that would hide others
LIBRARY = {
    "c": "exp fmax fminf j0 gamma printf malloc index size_t isnan cosf exit strlen tolower va_arg",
    "cpp": "exp fmax min max clamp lerp swap beta legendre printf",
    "hlsl": "lerp saturate mul min frac rcp tex2D WaveActiveSum asfloat",
    "glsl": "mix fract mod texture min noise1 dFdx mainImage iTime",
    "glsl-es": "mix fract mod texture texelFetch mainImage",
    "slang": "lerp saturate fract bwd_diff bit_cast",
    "metal": "mix fract min fabs powr as_type texture1d",
    "wgsl": "mix fract vec3f textureSample bitcast mat2x2f",
    "osl": "mix noise trace transform luminance main",
    "cuda": "exp rsqrtf normcdf atomicAdd make_float3 min",
    "python": "abs sum max id filter numpy",
    "javascript": "Object isNaN top name window parseFloat",
}
# Names that nothing in the code may have, since macros and words have no scope
WORDS = {
    "c": "NAN INFINITY M_PI HUGE_VAL EDOM NULL errno main unix near FLT_MAX PRId64 SIGINT double",
    "cpp": "NAN M_PI template class INT_MAX",
    "hlsl": "float3x3 min16float4 int16_t cbuffer Texture2DArray",
    "glsl": "mat2x3 sampler2DShadow dmat4 isampler2D f16vec3",
    "glsl-es": "mat2x3 sampler2DShadow",
    "slang": "float3x3 property",
    "metal": "NAN M_PI_F MAXFLOAT uchar4 half3x3 kernel",
    "wgsl": "fn let array",
    "osl": "M_PI M_2PI color closure",
    "cuda": "NAN float2 uchar4 longlong2 threadIdx",
    "python": "lambda np None",
    "javascript": "function let Math NaN",
}
# Near misses, which are free
FREE = "expo Fmax Nan mini main2 isotropic tone strength memory Distance FuzzQ lerp2"


def named(name, argument="x", **others):
    return function(name, [Parameter(argument, UNIT)], lambda x: x * x + 0.5, **others)


def precision(key):
    return "float" if "float" in LANGUAGES[key].types else "double"


def several(table):
    return [(key, name) for key, names in table.items() for name in names.split()]


def refusal(key, name):
    return re.escape(f"name {name!r} cannot be used in {LANGUAGES[key].name}; allowed: ")


@pytest.mark.parametrize(("key", "name"), several(LIBRARY) + several(WORDS))
def test_no_function_structure_or_namespace_has_a_name_of_the_library(key, name):
    with pytest.raises(ValueError, match=refusal(key, name)):
        write_source(named(name), key, precision(key))
    record = Record(name)
    held = function("Held", [Parameter("x", UNIT)], lambda x: (x,), result=1, record=record)
    with pytest.raises(ValueError, match=refusal(key, name)):
        write_source(held, key, precision(key))
    if LANGUAGES[key].namespaces:
        with pytest.raises(ValueError, match=refusal(key, name)):
            write_sections([Section((named("Free"),), {})], key, namespace=name)


@pytest.mark.parametrize(("key", "name"), several(WORDS))
def test_no_argument_has_the_name_of_a_word_or_macro(key, name):
    with pytest.raises(ValueError, match=refusal(key, name)):
        write_source(named("Free", name), key, precision(key))


@pytest.mark.parametrize("key", [key for key, each in LANGUAGES.items() if each.namespaces])
def test_a_namespace_is_one_identifier(key):
    for name in ("a b", "a::b", "2x", "", "x{}"):
        with pytest.raises(ValueError, match=f"namespace name {name!r} is no identifier"):
            write_sections([Section((named("Free"),), {})], key, namespace=name)


AT_ONCE = ("c", "cpp", "glsl", "python", "javascript")


@pytest.mark.parametrize(
    "key",
    [pytest.param(key, marks=[] if key in AT_ONCE else pytest.mark.slow) for key in LANGUAGES],
)
def test_code_with_accepted_names_compiles(key):
    kind = precision(key)
    chain = ready(key, kind)
    # Arguments hide what the library calls by these names.
    arguments = ("distance", "length", "index", "step", "gamma", "y0", "isnan", "size_t")
    functions = [named(name) for name in FREE.split()]
    functions += [named(f"Of{index}", name) for index, name in enumerate(arguments)]
    source = write_source(functions, key, kind)
    values = chain.run(source, functions[-1], np.array([[0.5], [0.75]]), kind)
    assert values.tolist() == [[0.75], [1.0625]]


HEADERS = words(
    "assert complex ctype errno fenv float inttypes limits locale math setjmp signal stdarg",
    "stdatomic stddef stdint stdio stdlib string threads time uchar wchar wctype",
)


@pytest.mark.parametrize(("headers", "standard"), [(sorted(HEADERS), "c11"), (["math"], "gnu17")])
def test_the_names_of_the_c_library_are_those_of_its_headers(headers, standard):
    if missing_command("gcc", "gcc") is not None:
        pytest.skip("gcc is not here")
    text = "".join(f"#include <{each}.h>\n" for each in headers)

    def preprocessed(*flags):
        command = ["gcc", f"-std={standard}", "-x", "c", "-E", "-P", *flags, "-"]
        done = subprocess.run(command, input=text, capture_output=True, text=True, check=True)
        return done.stdout

    macros = set(re.findall(r"#define ([A-Za-z]\w*)", preprocessed("-dM")))
    assert len(macros) > 20
    assert macros <= C_MACROS | C_LIBRARY | C_WORDS
    # A declaration without attributes and bodies: the name before the first parenthesis
    plain, code = None, preprocessed()
    while plain != code:
        plain, code = (
            code,
            re.sub(r"\{[^{}]*\}|__attribute__ *\(\((?:[^()]|\([^()]*\))*\)\)", "", code),
        )
    declared = {
        found[1]
        for statement in code.split(";")
        if "typedef" not in statement and (found := re.search(r"\b([A-Za-z]\w*) *\(", statement))
    }
    assert len(declared) > 200
    assert declared <= C_LIBRARY | C_WORDS


def test_the_names_of_python_are_those_of_this_python():
    known = LANGUAGES["python"].library | LANGUAGES["python"].reserved
    here = {name for name in dir(builtins) if not name.startswith("_")}
    assert len(here) > 100
    assert here <= known
