"""Printing: names, parentheses, literals, signatures, comments, and what is refused."""

import ctypes
import re
from dataclasses import replace
from functools import reduce

import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from programs.functions import Function, Parameter
from programs.languages import LANGUAGES, PRECISIONS, language, shortest_decimal
from programs.printing.printer import write_source

ALL = [(key, precision) for key in LANGUAGES for precision in LANGUAGES[key].types]
RNG = np.random.default_rng(11)
NUMERATOR, DENOMINATOR = RNG.normal(size=(2, 12))
UNIT = (0.0, 1.0)


def of_scalars(call, names="x", result=None, name="Example"):
    parameters = tuple(Parameter(each, UNIT) for each in names.split())
    return Function(name, "An example.", parameters, result, "results", call)


def one_line(call, names="x", language="c", precision="double"):
    """Return the expression that a function of one statement returns."""
    source = write_source(of_scalars(call, names), language, precision)
    return re.search(r"return (.*);", source)[1]


def rational(alpha, thetaF, count=6):
    """A rational function with sines, powers and a clamp, as fitted forms have."""
    alpha = jnp.clip(alpha, 0.15, 1.0)
    b = 1.0 - alpha
    g = jnp.cos(thetaF)
    d = jnp.sin(thetaF)
    terms = [b, g, d, b**2, g**2, b * g, b * d, b**3, g**3, d**3, b**2 * g, b * g**2]
    results = []
    for shift in range(count):
        num = sum(float(p) * x for p, x in zip(np.roll(NUMERATOR, shift), terms, strict=True))
        den = 20.0 + sum(float(q) * x for q, x in zip(DENOMINATOR, terms, strict=True))
        results.append(0.5 + b * num / den)
    return tuple(results)


COEFFICIENTS = Function(
    "CalcFuzzPsCoeffs",
    "Parameters of the fit.",
    (Parameter("alpha", (0.15, 1.0)), Parameter("thetaF", (0.1, 1.5707963267948966), "rad")),
    6,
    "c",
    rational,
)
TWO = replace(COEFFICIENTS, result=2, call=lambda alpha, thetaF: rational(alpha, thetaF, 2))
QUADRATIC = Function(
    "FuzzPs",
    "Value of the fit.",
    (Parameter("c", (-1.0, 1.0), size=6), Parameter("NdotU", UNIT), Parameter("TdotU", UNIT)),
    None,
    "result",
    lambda c, n, t: c[0] + c[1] * n + c[2] * t + c[3] * n * n + c[4] * n * t + c[5] * t * t,
)

GOLDEN = """\
// Quantity: P_s, the fraction of light scattered towards the base layer
// Equation: 1 - P_s = lambda^2 sqrt(lambda + c)

#include <math.h>

// An example.
// alpha in [0, 1], thetaF in [0, 1].
static inline float Example(float alpha, float thetaF)
{
    const float beta = 1.0f - alpha;
    const float beta2 = beta * beta;
    const float num = 0.1f - beta * (0.25f + 0.30887988f * beta2 * beta);
    const float sinThetaF = sinf(thetaF);
    const float wave = sinThetaF * beta2 - cosf(thetaF);
    return 0.5f + beta2 * num / (1.0f + wave + sqrtf(sinThetaF));
}
"""


def test_printed_code_has_the_names_and_structure_of_the_function():
    def call(alpha, thetaF):
        beta = 1.0 - alpha
        num = 0.1 - beta * (0.25 + 0.30887988209724426 * beta**2 * beta)
        wave = jnp.sin(thetaF) * beta**2 - jnp.cos(thetaF)
        return 0.5 + beta**2 * num / (1.0 + wave + jnp.sqrt(jnp.sin(thetaF)))

    header = {
        "Quantity": "P_s, the fraction of light scattered towards the base layer",
        "Equation": "1 − P_s = λ² sqrt(λ + c)",
    }
    assert write_source(of_scalars(call, "alpha thetaF"), "c", header=header) == GOLDEN


EXPRESSIONS = {
    "a - (b - c)": lambda a, b, c: a - (b - c),
    "a - b - c": lambda a, b, c: a - b - c,
    "a + (b + c)": lambda a, b, c: a + (b + c),
    "a * (b * c)": lambda a, b, c: a * (b * c),
    "a / (b * c)": lambda a, b, c: a / (b * c),
    "a / b / c": lambda a, b, c: a / b / c,
    "a / (b / c)": lambda a, b, c: a / (b / c),
    "a * b / c": lambda a, b, c: a * b / c,
    "(a + b) * c": lambda a, b, c: (a + b) * c,
    "a + b * c": lambda a, b, c: a + b * c,
    "-(a + b)": lambda a, b, c: -(a + b),
    "-a * b": lambda a, b, c: -a * b,
    "a - 1.5": lambda a, b, c: a + -1.5,
    "a + 1.5": lambda a, b, c: a - -1.5,
    "a - 1.5 * b": lambda a, b, c: a + -1.5 * b,
    "a + 1.5 * b * c": lambda a, b, c: a - -1.5 * b * c,
    "a * (-1.5)": lambda a, b, c: a * -1.5,
    "a / (-b)": lambda a, b, c: a / -b,
    "a + b * (0.5 + c * (0.25 + a))": lambda a, b, c: a + b * (0.5 + c * (0.25 + a)),
    "a > b ? c : 1.0": lambda a, b, c: jnp.where(a > b, c, 1.0),
    "2.0 * (a > b ? c : 1.0)": lambda a, b, c: 2.0 * jnp.where(a > b, c, 1.0),
    "a < b + c && (a > c || b > c) ? a : c": lambda a, b, c: jnp.where(
        (a < b + c) & ((a > c) | (b > c)), a, c
    ),
    "a < b ? pow(c, a) : sqrt(a + b)": lambda a, b, c: jnp.where(
        ~(a < b), jnp.sqrt(a + b), jnp.power(c, a)
    ),
}


@pytest.mark.parametrize("expected", EXPRESSIONS)
def test_only_needed_parentheses_are_printed(expected):
    assert one_line(EXPRESSIONS[expected], "a b c") == expected


SIGNATURES = {
    "c": (
        "static inline void CalcFuzzPsCoeffs(float alpha, float thetaF, float c[6])",
        "static inline float FuzzPs(const float c[6], float NdotU, float TdotU)",
    ),
    "cpp": (
        "inline void CalcFuzzPsCoeffs(float alpha, float thetaF, float (&c)[6])",
        "inline float FuzzPs(const float (&c)[6], float NdotU, float TdotU)",
    ),
    "hlsl": (
        "void CalcFuzzPsCoeffs(float alpha, float thetaF, out float c[6])",
        "float FuzzPs(in float c[6], float NdotU, float TdotU)",
    ),
    "glsl": (
        "void CalcFuzzPsCoeffs(float alpha, float thetaF, out float c[6])",
        "float FuzzPs(in float c[6], float NdotU, float TdotU)",
    ),
    "glsl-es": (
        "void CalcFuzzPsCoeffs(highp float alpha, highp float thetaF, out highp float c[6])",
        "highp float FuzzPs(in highp float c[6], highp float NdotU, highp float TdotU)",
    ),
    "slang": (
        "void CalcFuzzPsCoeffs(float alpha, float thetaF, out float c[6])",
        "float FuzzPs(in float c[6], float NdotU, float TdotU)",
    ),
    "metal": (
        "inline void CalcFuzzPsCoeffs(float alpha, float thetaF, thread float (&c)[6])",
        "inline float FuzzPs(thread const float (&c)[6], float NdotU, float TdotU)",
    ),
    "wgsl": (
        "fn CalcFuzzPsCoeffs(alpha: f32, thetaF: f32, c: ptr<function, array<f32, 6>>)",
        "fn FuzzPs(c: array<f32, 6>, NdotU: f32, TdotU: f32) -> f32",
    ),
    "osl": (
        "void CalcFuzzPsCoeffs(float alpha, float thetaF, output float c[6])",
        "float FuzzPs(float c[6], float NdotU, float TdotU)",
    ),
    "cuda": (
        "__host__ __device__ inline "
        "void CalcFuzzPsCoeffs(float alpha, float thetaF, float (&c)[6])",
        "__host__ __device__ inline float FuzzPs(const float (&c)[6], float NdotU, float TdotU)",
    ),
    "python": ("def CalcFuzzPsCoeffs(alpha, thetaF):", "def FuzzPs(c, NdotU, TdotU):"),
    "javascript": (
        "function CalcFuzzPsCoeffs(alpha, thetaF)",
        "function FuzzPs(c, NdotU, TdotU)",
    ),
}


@pytest.mark.parametrize("key", LANGUAGES)
def test_signatures_in_every_language(key):
    precision = "float" if "float" in LANGUAGES[key].types else "double"
    lines = write_source([COEFFICIENTS, QUADRATIC], key, precision).splitlines()
    for signature in SIGNATURES[key]:
        assert lines.count(signature) == 1


@pytest.mark.parametrize(("key", "precision"), ALL)
@pytest.mark.parametrize("constants", ["inline", "table"])
def test_printed_functions_are_readable_in_every_language(key, precision, constants):
    function = QUADRATIC if precision == "double" and key in NO_FUNCTIONS else TWO
    header = {"Made": "word " * 60}
    source = write_source(function, key, precision, constants=constants, header=header)
    lines = source.splitlines()
    assert max(map(len, lines)) <= 100
    assert not any(line != line.rstrip() for line in lines)
    if function is TWO:
        assert len(re.findall(r"\bsin[f(]", source)) == 1
        assert len(re.findall(r"\bcos[f(]", source)) == 1
        # The square of b is computed once and has a name.
        assert len(re.findall(r"\bb \* b\b", source)) == 1
        assert len(re.findall(r"\bb2 = b \* b\b", source)) == 1
        assert ("coefficients[3]" in source) == (constants == "table")


NO_FUNCTIONS = ("hlsl", "glsl", "slang")


DEEP = {
    "Horner": lambda x: reduce(lambda rest, k: k + 0.123 + x * rest, np.arange(60.0), x),
    "calls": lambda x: reduce(lambda inner, k: jnp.sin(inner) * x + k, np.arange(60.0), x),
    "signs": lambda x: reduce(lambda inner, k: 1.0 - inner / (x - k), np.arange(60.0), x),
    "selections": lambda x: reduce(
        lambda inner, k: jnp.where(x > k, jnp.maximum(inner, k), x * inner), np.arange(40.0), x
    ),
}


@pytest.mark.parametrize("key", ["c", "wgsl", "python"])
@pytest.mark.parametrize("name", DEEP)
def test_deeply_nested_expressions_have_short_lines(key, name):
    source = write_source(of_scalars(DEEP[name]), key)
    assert max(map(len, source.splitlines())) <= 100
    if name == "Horner":
        # 60 short terms share lines.
        assert len(source.splitlines()) < 30


def test_a_table_holds_each_fitted_constant_once():
    source = write_source(COEFFICIENTS, "c", "double", constants="table")
    (table,) = re.findall(r"coefficients\[(\d+)\] = \{(.*?)\};", source, re.DOTALL)
    numbers = [float(text) for text in table[1].split(",")]
    assert len(numbers) == int(table[0]) == len(set(numbers))
    assert set(numbers) == set(NUMERATOR) | set(DENOMINATOR)
    used = [int(i) for i in re.findall(r"coefficients\[(\d+)\]", source)][1:]
    # Constants are numbered in the order in which they are used.
    assert list(dict.fromkeys(used)) == list(range(len(numbers)))


@pytest.mark.parametrize("precision", PRECISIONS)
@given(value=st.floats(allow_nan=False, allow_infinity=False))
def test_literals_read_back_as_the_same_number(precision, value):
    dtype = PRECISIONS[precision]
    with np.errstate(over="ignore"):
        rounded = dtype(value)
    if not np.isfinite(rounded):
        with pytest.raises(ValueError, match=f"is no {precision}; allowed: at most"):
            shortest_decimal(value, precision)
        return
    text = shortest_decimal(value, precision)
    assert re.fullmatch(r"-?\d+\.\d+(e[-+]?\d+)?", text)
    # A compiler may round the decimal directly, or to a double first.
    assert dtype(float(text)) == rounded
    if precision == "float":
        assert np.float32(_strtof(text.encode(), None)) == rounded


_strtof = ctypes.CDLL(None).strtof
_strtof.argtypes, _strtof.restype = [ctypes.c_char_p, ctypes.c_void_p], ctypes.c_float


@given(st.floats(2**-10, 1024.0, width=32))
def test_no_shorter_literal_reads_back(value):
    digits = len(re.sub(r"\D", "", shortest_decimal(value, "float")).strip("0"))
    if digits > 1:
        assert np.float32(f"{value:.{digits - 2}e}") != np.float32(value)


@pytest.mark.parametrize(
    ("key", "precision", "literal"),
    [
        ("c", "half", "(_Float16)0.1f"),
        ("c", "float", "0.1f"),
        ("c", "double", "0.1"),
        ("cpp", "half", "_Float16(0.1f)"),
        ("hlsl", "half", "0.1h"),
        ("hlsl", "double", "0.1L"),
        ("glsl", "half", "0.1hf"),
        ("glsl", "float", "0.1"),
        ("glsl", "double", "0.1lf"),
        ("wgsl", "half", "0.1h"),
        ("wgsl", "float", "0.1f"),
        ("metal", "half", "0.1h"),
        ("osl", "float", "0.1"),
        ("python", "half", "0.1"),
        ("javascript", "double", "0.1"),
    ],
)
def test_literals_have_the_suffix_of_their_precision(key, precision, literal):
    assert one_literal(key, precision) == literal


def one_literal(key, precision):
    source = write_source(of_scalars(lambda x: x * 0.1), key, precision)
    return re.search(r"x \* (.*?);?$", source, re.MULTILINE)[1]


REFUSED_NAMES = {
    "c": ["double", "restrict", "sqrtf", "_x", "a__b"],
    "cpp": ["template", "operator", "std"],
    "hlsl": ["cbuffer", "out", "lerp__", "float3"],
    "glsl": ["uniform", "gl_Position", "vec3", "inversesqrt"],
    "slang": ["extension", "property", "func"],
    "metal": ["thread", "kernel", "half"],
    "wgsl": ["fn", "let", "array", "f32"],
    "osl": ["output", "color", "closure"],
    "cuda": ["__global__", "threadIdx"],
    "python": ["lambda", "np", "None"],
    "javascript": ["function", "let", "Math"],
}


@pytest.mark.parametrize(
    ("key", "name"), [(k, n) for k, names in REFUSED_NAMES.items() for n in names]
)
def test_reserved_names_are_refused(key, name):
    precision = next(iter(LANGUAGES[key].types))
    spelled = re.escape(f"name {name!r} cannot be used in {LANGUAGES[key].name}; allowed: ")
    with pytest.raises(ValueError, match=spelled):
        write_source(of_scalars(jnp.sqrt, name=name), key, precision)
    with pytest.raises(ValueError, match=spelled):
        write_source(of_scalars(lambda x: x + 1.0, name), key, precision)
    with pytest.raises(ValueError, match=spelled):
        write_source(replace(COEFFICIENTS, result_name=name), key, precision)


def test_the_author_s_variable_names_become_valid_identifiers():
    def call(x):
        double = x * 1.5 + 0.25
        λ = double * double + x  # noqa: PLC2401
        results = λ * λ + double
        __hidden__ = results * results + λ
        Example = __hidden__ * __hidden__ + results
        return Example * Example + double

    source = write_source(of_scalars(call), "c")
    names = re.findall(r"const float (\w+) =", source)
    assert names == ["double_2", "lambda", "results", "hidden", "Example_2"]


def test_unnamed_values_are_named_after_their_operands():
    def call(alpha, b):
        def twice(value):
            return value * (value + 3.0)

        return (
            twice(1.0 - alpha) + twice(alpha * alpha) + twice(alpha * b) + twice(b * b * b)
            + twice(jnp.sqrt(b)) + twice(b + b) + twice(b - alpha)
        )  # fmt: skip

    source = write_source(of_scalars(call, "alpha b"), "c")
    found = dict(re.findall(r"const float (\w+) = (.*);", source))
    assert found == {
        "oneMinusAlpha": "1.0f - alpha",
        "alpha2": "alpha * alpha",
        "product": "alpha * b",
        "b3": "b * b * b",
        "sqrtB": "sqrtf(b)",
        "twiceB": "b + b",
        "difference": "b - alpha",
    }


def test_a_clamped_argument_gets_a_name_of_its_own():
    def call(alpha):
        alpha = jnp.clip(alpha, 0.15, 1.0)
        return alpha * alpha

    lines = write_source(of_scalars(call, "alpha"), "c").splitlines()
    assert [line.strip() for line in lines[6:-1]] == [
        "const float alphaAtLeast = alpha > 0.15f ? alpha : 0.15f;",
        "const float alphaClamped = alphaAtLeast < 1.0f ? alphaAtLeast : 1.0f;",
        "return alphaClamped * alphaClamped;",
    ]


@pytest.mark.parametrize(
    ("language", "unit", "other"),
    [
        ("hlsl", "saturate(x)", "clamp(x, 0.25f, 0.75f)"),
        ("wgsl", "saturate(x)", "clamp(x, 0.25f, 0.75f)"),
        ("metal", "metal::saturate(x)", "metal::clamp(x, 0.25f, 0.75f)"),
        ("glsl", "clamp(x, 0.0, 1.0)", "clamp(x, 0.25, 0.75)"),
        ("osl", "clamp(x, 0.0, 1.0)", "clamp(x, 0.25, 0.75)"),
        ("cuda", "fminf(fmaxf(x, 0.0f), 1.0f)", "fmaxf(fminf(x, 0.75f), 0.25f)"),
    ],
)
def test_a_clamp_is_written_by_the_languages_own_function(language, unit, other):
    def call(x):
        return jnp.clip(x, 0.0, 1.0) / jnp.maximum(jnp.minimum(x, 0.75), 0.25)

    assert f"return {unit} / {other};" in write_source(of_scalars(call, "x"), language)


def test_a_bound_that_is_not_a_constant_is_no_clamp():
    def call(x, y):
        return jnp.minimum(jnp.maximum(x, 0.0), y) + jnp.minimum(jnp.maximum(x, 1.0), 0.5)

    source = write_source(of_scalars(call, "x y"), "hlsl")
    assert "min(max(x, 0.0f), y)" in source
    # The ends are not in order.
    assert "min(max(x, 1.0f), 0.5f)" in source


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("rust",), "target 'rust' is unknown; allowed: c, cpp, .*javascript"),
        (("javascript",), "precision 'float' is not in JavaScript; allowed: double"),
        (("c", "quad"), "precision 'quad' is not in C; allowed: half, float, double"),
        (("wgsl", "double"), "precision 'double' is not in WGSL; allowed: half, float"),
    ],
)
def test_unknown_languages_and_precisions_are_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        write_source(QUADRATIC, *arguments)


def test_unknown_constants_are_refused():
    with pytest.raises(ValueError, match="constants 'global' is unknown; allowed: inline, table"):
        write_source(QUADRATIC, "c", constants="global")


@pytest.mark.parametrize(
    ("call", "key", "precision", "message"),
    [
        (jnp.expm1, "glsl", "double", "'exp' cannot be written in GLSL at double precision"),
        (jnp.exp, "glsl", "double", "'exp' cannot be written in GLSL at double"),
        (jnp.sin, "slang", "double", "'sin' cannot be written in Slang at double"),
        (jnp.sqrt, "hlsl", "double", "'sqrt' cannot be written in HLSL at double"),
    ],
)
def test_an_operation_that_a_language_lacks_is_named_in_the_error(call, key, precision, message):
    with pytest.raises(ValueError, match=message + r".*allowed: .*\badd\b.*\bmax\b"):
        write_source(of_scalars(call), key, precision)


def test_a_constant_out_of_range_is_refused():
    function = of_scalars(lambda x: x * 1e5)
    assert "100000.0f" in write_source(function, "c")
    with pytest.raises(ValueError, match=r"Example: constant 100000.0 is no half; .*65504"):
        write_source(function, "c", "half")
    with pytest.raises(ValueError, match="constant inf is no double"):
        write_source(of_scalars(lambda x: jnp.minimum(x, jnp.inf)), "c", "double")


def test_a_program_too_long_for_its_language_is_refused():
    small = replace(language("c"), max_operations=12)
    with pytest.raises(ValueError, match="FuzzPs takes 13 operations; allowed in C: at most 12"):
        write_source(QUADRATIC, small)
    assert "FuzzPs" in write_source(QUADRATIC, replace(small, max_operations=13))


def test_several_functions_are_printed_with_one_prologue_and_distinct_names():
    source = write_source([COEFFICIENTS, QUADRATIC], "c", header={"Made": "by hand"})
    assert source.startswith("// Made: by hand\n\n#include <math.h>\n\n// Parameters of the fit.\n")
    assert source.count("#include") == 1
    assert source.index("CalcFuzzPsCoeffs") < source.index("FuzzPs(")
    with pytest.raises(ValueError, match="function name 'FuzzPs' occurs twice"):
        write_source([QUADRATIC, QUADRATIC], "c")
    with pytest.raises(ValueError, match="'FuzzPs' is a function and a parameter"):
        write_source([QUADRATIC, of_scalars(jnp.sin, "FuzzPs")], "c")


@pytest.mark.parametrize("key", LANGUAGES)
def test_no_text_of_a_header_escapes_the_comment(key):
    precision = next(iter(LANGUAGES[key].types))
    text = (
        "first line\nsecond line */ \\ \u2028 \x1b\x9b\b\u202eθf ∈ [0, π/2] ½ "
        + "long " * 40
        + "\\"
    )
    source = write_source(QUADRATIC, key, precision, header={"Label\n": text})
    comment = [line for line in source.splitlines() if line.startswith(LANGUAGES[key].comment)]
    assert source.isascii() and source.replace("\n", "").isprintable()
    assert "theta_f in [0, pi/2] 1/2" in source
    assert "\\" not in source
    assert (
        source.split("\n\n")[0].splitlines() == comment[: source.split("\n\n")[0].count("\n") + 1]
    )


def test_units_and_domains_are_printed_above_the_function():
    assert "// alpha in [0.15, 1], thetaF in [0.1, 1.5708] rad.\n" in write_source(
        COEFFICIENTS, "c"
    )


def test_printed_python_accepts_arrays_that_broadcast():
    names = {}
    exec(write_source([COEFFICIENTS, QUADRATIC], "python"), names)
    alpha = np.linspace(0.2, 0.9, 5)[:, None]
    theta = np.linspace(0.1, 1.5, 4)
    coefficients = names["CalcFuzzPsCoeffs"](alpha, theta)
    assert len(coefficients) == 6
    assert {(c.shape, c.dtype) for c in coefficients} == {((5, 4), np.dtype(np.float32))}
    assert names["FuzzPs"](coefficients, 0.5, theta).shape == (5, 4)


def test_printed_python_keeps_the_precision_of_constants():
    function = of_scalars(lambda x: (jnp.where(x > 0.5, 0.1, 0.2) * 3.0, jnp.asarray(0.1)), "x", 2)
    names = {}
    exec(write_source(function, "python", "half"), names)
    chosen, constant = names["Example"](np.array([0.25, 0.75]))
    assert chosen.dtype == constant.dtype == np.float16
    np.testing.assert_array_equal(chosen, np.float16([0.2, 0.1]) * np.float16(3.0))
