"""Three functions written by hand in every language are compiled, run and compared with NumPy."""

import numpy as np
import pytest

from programs.functions import Function, Parameter
from programs.precision import number_type
from programs.toolchains import cuda, hlsl, osl, toolchain
from tests.programs.toys import ready

pytestmark = pytest.mark.usefixtures("clean_folder")

UNIT = (-1.0, 1.0)
SCALAR = Function("Ratio", "one in, one out", (Parameter("x", UNIT),), None, "y", lambda x: x)
FILL = Function(
    "Fill",
    "two in, six out",
    (Parameter("alpha", UNIT), Parameter("thetaF", UNIT)),
    6,
    "c",
    lambda alpha, theta: (alpha, theta),
)
FORM = Function(
    "Form",
    "an array and two in, one out",
    (Parameter("c", UNIT, size=6), Parameter("NdotU", UNIT), Parameter("TdotU", UNIT)),
    None,
    "value",
    lambda c, n, t: n,
)

# The bodies, in a syntax that all languages here share; `@2@` stands for the literal 2.
RATIO_BODY = "(@1@ + @0.5@ * x) / (@2@ + x * x)"
FILL_BODY = (
    "alpha",
    "alpha * thetaF",
    "alpha + thetaF",
    "(alpha + thetaF) * (alpha - thetaF)",
    "alpha / (@3@ + thetaF)",
    "(alpha * alpha + thetaF) + @0.25@",
)
FORM_BODY = (
    "((c[0] + c[1] * NdotU) + (c[2] * TdotU + c[3] * (NdotU * NdotU)))"
    " + (c[4] * (NdotU * TdotU) + c[5] * (TdotU * TdotU))"
)

SPELLED = {
    "c": {"half": "_Float16", "float": "float", "double": "double"},
    "cpp": {"half": "_Float16", "float": "float", "double": "double"},
    "glsl": {"half": "float16_t", "float": "float", "double": "double"},
    "glsl-es": {"float": "highp float"},
    "hlsl": {"half": "half", "float": "float", "double": "double"},
    "slang": {"half": "half", "float": "float", "double": "double"},
    "metal": {"half": "half", "float": "float"},
    "cuda": {"half": "__half", "float": "float", "double": "double"},
    "wgsl": {"half": "f16", "float": "f32"},
    "osl": {"float": "float"},
    "python": {"half": "np.float16", "float": "np.float32", "double": "np.float64"},
    "javascript": {"double": "Number"},
}
PREFIX = {"cuda": "__host__ __device__ "}
OUT = {
    "c": "{T} c[6]",
    "cpp": "{T} (&c)[6]",
    "glsl": "out {T} c[6]",
    "glsl-es": "out {T} c[6]",
    "hlsl": "out {T} c[6]",
    "slang": "out {T} c[6]",
    "metal": "thread {T} (&c)[6]",
    "cuda": "{T} (&c)[6]",
    "osl": "output {T} c[6]",
}
IN = {
    "c": "const {T} c[6]",
    "cpp": "const {T} (&c)[6]",
    "glsl": "in {T} c[6]",
    "glsl-es": "in {T} c[6]",
    "hlsl": "in {T} c[6]",
    "slang": "in {T} c[6]",
    "metal": "thread const {T} (&c)[6]",
    "cuda": "const {T} (&c)[6]",
    "osl": "{T} c[6]",
}
HEAD = {
    "metal": "#include <metal_stdlib>\nusing namespace metal;\n",
    "python": "import numpy as np\n",
}


def source(language, function, precision):
    """Write one of the three functions in a language and precision."""
    kind = SPELLED[language][precision]
    write = {"wgsl": _wgsl, "python": _python, "javascript": _javascript}.get(language, _c_like)
    text = HEAD.get(language, "") + write(language, function, kind)
    pieces = text.split("@")
    for index in range(1, len(pieces), 2):
        pieces[index] = _literal(language, kind, float(pieces[index]))
    return "".join(pieces)


def _literal(language, kind, value):
    if language in ("osl", "wgsl", "javascript", "glsl-es") or kind in ("double", "np.float64"):
        return repr(value)
    if kind == "float":
        return f"{value!r}f"
    return f"({kind})({value!r}f)" if kind == "_Float16" else f"{kind}({value!r})"


def _c_like(language, function, kind):
    prefix = PREFIX.get(language, "")
    if function is SCALAR:
        return f"{prefix}{kind} Ratio({kind} x) {{ return {RATIO_BODY}; }}\n"
    if function is FORM:
        array = IN[language].format(T=kind)
        head = f"{prefix}{kind} Form({array}, {kind} NdotU, {kind} TdotU)"
        return f"{head} {{\n    return {FORM_BODY};\n}}\n"
    rows = "".join(f"    c[{i}] = {body};\n" for i, body in enumerate(FILL_BODY))
    array = OUT[language].format(T=kind)
    return f"{prefix}void Fill({kind} alpha, {kind} thetaF, {array}) {{\n{rows}}}\n"


def _wgsl(language, function, kind):
    if function is SCALAR:
        return f"fn Ratio(x: {kind}) -> {kind} {{ return {RATIO_BODY}; }}\n"
    array = f"array<{kind}, 6>"
    if function is FORM:
        head = f"fn Form(c: {array}, NdotU: {kind}, TdotU: {kind}) -> {kind}"
        return f"{head} {{\n    return {FORM_BODY};\n}}\n"
    rows = "".join(f"    (*c)[{i}] = {body};\n" for i, body in enumerate(FILL_BODY))
    return f"fn Fill(alpha: {kind}, thetaF: {kind}, c: ptr<function, {array}>) {{\n{rows}}}\n"


def _python(language, function, kind):
    if function is SCALAR:
        return f"def Ratio(x):\n    return {RATIO_BODY}\n"
    if function is FORM:
        return f"def Form(c, NdotU, TdotU):\n    return {FORM_BODY}\n"
    return f"def Fill(alpha, thetaF):\n    return ({', '.join(FILL_BODY)})\n"


def _javascript(language, function, kind):
    if function is SCALAR:
        return f"function Ratio(x) {{ return {RATIO_BODY}; }}\n"
    if function is FORM:
        return f"function Form(c, NdotU, TdotU) {{ return {FORM_BODY}; }}\n"
    return f"function Fill(alpha, thetaF) {{ return [{', '.join(FILL_BODY)}]; }}\n"


def reference(function, points, kind):
    """Evaluate in NumPy, every operation rounded to `kind`; (n, k) in, (n, m) float64 out."""
    columns = [column.astype(kind) for column in points.T]
    one, half, two, quarter, three = (kind(value) for value in (1, 0.5, 2, 0.25, 3))
    if function is SCALAR:
        (x,) = columns
        rows = [(one + half * x) / (two + x * x)]
    elif function is FILL:
        a, t = columns
        rows = [a, a * t, a + t, (a + t) * (a - t), a / (three + t), (a * a + t) + quarter]
    else:
        *c, n, t = columns
        rows = [
            ((c[0] + c[1] * n) + (c[2] * t + c[3] * (n * n))) + (c[4] * (n * t) + c[5] * (t * t))
        ]
    return np.stack(rows, 1).astype(np.float64)


# Code for the processor rounds every operation once, as NumPy does. Compilers of shaders, and
# Blender's, may fuse a product and a sum. That changes these sums, of at most six terms below 1,
# by a few units in the last place.
FUSED = 6.0
FUSING = ("glsl", "glsl-es", "hlsl", "slang", "wgsl", "osl")


def sample_points(function, precision, rows=2000):
    """Return the corners of the domain, points near zero, and random points."""
    width = sum(parameter.size or 1 for parameter in function.parameters)
    special = np.repeat([[-1.0], [-0.0], [0.0], [2.0**-12], [1.0]], width, 1)
    points = np.vstack([special, np.random.default_rng(7).uniform(-1, 1, (rows, width))])
    return points.astype(number_type(precision)).astype(np.float64)


PRECISIONS = [(language, precision) for language, kinds in SPELLED.items() for precision in kinds]
# Every language in its first precision, which has the smallest range
LEAST = [(language, next(iter(kinds))) for language, kinds in SPELLED.items() if language != "cuda"]
# FORM takes an array and shows every rounding, so it is tested in each precision, the other two in
# one. nvcc is slow, so it gets one function for each precision.
CASES = [
    *((language, precision, FORM) for language, precision in PRECISIONS if language != "cuda"),
    *(
        (language, "float", SCALAR)
        for language in SPELLED
        if language not in ("cuda", "javascript")
    ),
    *((language, "float", FILL) for language in SPELLED if language not in ("cuda", "javascript")),
    ("cuda", "half", FORM),
    ("cuda", "float", FILL),
    ("cuda", "double", SCALAR),
    ("javascript", "double", FILL),
]


@pytest.mark.parametrize(
    ("language", "precision", "function"),
    [pytest.param(*case, id="-".join((*case[:2], case[2].name))) for case in CASES],
)
def test_values_equal_those_of_numpy(language, precision, function):
    points = sample_points(function, precision)
    values = ready(language, precision).run(
        source(language, function, precision), function, points, precision
    )
    expected = reference(function, points, number_type(precision))
    assert values.dtype == np.float64
    exact = language not in FUSING or (language == "osl" and osl.renderer() is None)
    allowed = 0.0 if exact else FUSED * np.finfo(number_type(precision)).eps
    np.testing.assert_allclose(values, expected, rtol=0, atol=allowed)
    if function is FORM and precision != "double":
        # If the code computed in a higher precision and rounded once, all errors would be within
        # half a unit in the last place. If each step is rounded, some are larger.
        exact = reference(function, points, np.float64)
        unit = np.spacing(np.abs(exact).astype(number_type(precision))).astype(np.float64)
        assert (np.abs(values - exact) / unit).max() > 0.75


@pytest.mark.parametrize(("language", "precision"), LEAST)
def test_the_largest_and_smallest_numbers_are_passed_unchanged(language, precision):
    largest = float(np.sqrt(np.finfo(number_type(precision)).max)) / 2
    smallest = float(np.finfo(number_type(precision)).tiny)
    points = np.array([[-largest], [-1.0], [-smallest], [0.0], [smallest], [largest]])
    points = points.astype(number_type(precision)).astype(np.float64)
    values = ready(language, precision).run(
        source(language, SCALAR, precision), SCALAR, points, precision
    )
    expected = reference(SCALAR, points, number_type(precision))
    assert np.isfinite(expected).all()
    relative = FUSED * np.finfo(number_type(precision)).eps
    np.testing.assert_allclose(values, expected, rtol=relative, atol=smallest)


@pytest.mark.parametrize("language", ["c", "wgsl"])
def test_many_rows_come_back_in_order(language):
    # More rows than one dispatch of the device has, and not a multiple of the group size
    points = np.linspace(-1, 1, (1 << 18) + 77)[:, None]
    values = ready(language, "float").run(
        source(language, SCALAR, "float"), SCALAR, points, "float"
    )
    expected = reference(SCALAR, points, np.float32)
    np.testing.assert_allclose(values, expected, rtol=FUSED * np.finfo(np.float32).eps)


@pytest.mark.parametrize("function", [SCALAR, FILL, FORM], ids=lambda function: function.name)
@pytest.mark.parametrize(
    ("language", "finder"), [("cuda", "_compiler"), ("hlsl", "_library")], ids=["cuda", "hlsl"]
)
def test_a_substitute_compiler_is_used_without_the_proper_one(
    language, finder, function, monkeypatch
):
    module = {"cuda": cuda, "hlsl": hlsl}[language]
    monkeypatch.setattr(module, finder, lambda: None)
    points = sample_points(function, "float")
    values = ready(language, "float").run(
        source(language, function, "float"), function, points, "float"
    )
    expected = reference(function, points, np.float32)
    allowed = 0.0 if language == "cuda" else FUSED * np.finfo(np.float32).eps
    np.testing.assert_allclose(values, expected, rtol=0, atol=allowed)
    assert {"cuda": "shim", "hlsl": "lslang"}[language] in toolchain(language).tool
    # Neither of the substitutes has 16-bit types.
    assert toolchain(language).missing("half") is not None
