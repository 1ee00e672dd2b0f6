"""The exported code of every quantity: it is the form, it runs, and its header tells its errors."""

import functools
import os
import re
from dataclasses import replace

import jax.numpy as jnp
import numpy as np
import pytest

from coefficients import code_header, exported_code
from coefficients.catalogue import entries, resolve
from coefficients.code_header import closed_form_beside, cost_text, costs
from coefficients.exported_code import (
    EXPONENT,
    exported_values,
    operations_of,
    programs_of,
    source_file,
    trial_of,
)
from fitting import form_values
from fitting.points.grids import sobol_points
from programs import (
    LANGUAGES,
    Cost,
    Parameter,
    check,
    function,
    language,
    precision_of,
    toolchain,
    write_source,
)
from programs.toolchains import verification
from programs.toolchains.interface import Toolchain
from programs.toolchains.verification import corners, difference, run_code

CLOSED_FORM = "exact/ps"
EXACT = ("exact/ps", "exact/g", "exact/q", "exact/velvet")
NAMES = ["ps", "g", "q", "r", "velvet", *EXACT]
# In float32 over α from 0.05 to 1: what the closed form of P_s is exported for.
EXACT_ERROR = 3e-6


@functools.cache
def trial(name: str, precision: str, exponent: int = 11):
    return trial_of(resolve(name), precision, exponent)


def needs(key: str, precision: str = "float") -> None:
    reason = toolchain(key).missing(precision)
    if reason is not None:
        pytest.skip(reason)


# Values


@pytest.mark.parametrize("name", [entry.name for entry in entries()])
def test_the_code_that_is_exported_is_the_form_that_was_fitted(name):
    entry = resolve(name)
    points = np.concatenate([corners(entry.axes), sobol_points(entry.axes, 8, 1)])
    expected = form_values(entry.require_fitted(), points)
    if entry.problem.calling.codomain is not None:
        expected = np.clip(expected, *entry.problem.calling.codomain)
    # Both are float64; the forms' quotients lose up to three digits.
    np.testing.assert_allclose(exported_values(entry, points), expected, rtol=0, atol=1e-12)


@pytest.mark.parametrize("name", EXACT)
def test_the_code_of_a_closed_form_is_exact(name):
    entry = resolve(name)
    points = sobol_points(entry.axes, 8, 1)
    exact = entry.problem.reference.values(points)
    np.testing.assert_allclose(exported_values(entry, points), exact, rtol=0, atol=1e-12)


def test_values_have_the_shape_of_their_points():
    entry = resolve("ps")
    points = sobol_points(entry.axes, 4, 1)
    square = exported_values(entry, points.reshape(2, 8, 4))
    assert square.shape == (2, 8)
    np.testing.assert_array_equal(square.ravel(), exported_values(entry, points))


def test_values_are_clamped_as_the_code_clamps():
    entry = resolve("q")
    outside, end = exported_values(entry, np.array([[7.0], [0.5]]))
    assert outside == end


# Verification in every language

# Every language in the precision that it is written in by default, and the closed form, which needs
# nothing that a language may lack, in all of them. nvcc takes seconds a function.
CASES = [
    (name, key, precision)
    for name in ["ps", "g", "q", "r", "velvet", CLOSED_FORM]
    for key, spelled in LANGUAGES.items()
    for precision in spelled.types
    if (name == CLOSED_FORM or precision == precision_of(key, None))
    and (key != "cuda" or (name in ("ps", CLOSED_FORM) and precision == "float"))
] + [
    ("best/ps-40", "c", "half"),
    ("best/ps-40", "wgsl", "half"),
    ("r", "wgsl", "half"),
    *((name, "c", "float") for name in EXACT if name != CLOSED_FORM),
]


# The forms of these have no operation that the others lack. The tables are run in C below.
_SLOW = {key: [pytest.mark.slow] for key in ("g", "q", "r", "velvet", "exact/g", "exact/q")}


@pytest.mark.parametrize(
    ("name", "key", "precision"),
    [pytest.param(*case, marks=_SLOW.get(case[0], [])) for case in CASES],
)
def test_every_language_passes_or_is_not_checked(name, key, precision):
    result = check(trial(name, precision), key)
    if result.status == "not checked":
        assert result.reason and result.form is None
        assert key not in ("c", "cpp", "python", "javascript"), result.reason
        pytest.skip(result.reason)
    assert result.status == "passed", result.reason
    assert result.points == len(trial(name, precision).points)
    assert result.form.largest <= result.allowed.largest
    assert result.tool and result.note


@pytest.mark.parametrize("name", ["ps", "g", "q", "r", "velvet", CLOSED_FORM])
def test_a_hundred_thousand_points_and_the_corners_pass_in_c(name):
    needs("c")
    result = check(trial(name, "float", EXPONENT), "c")
    assert result.status == "passed", result.reason
    assert result.points >= 100_000
    # The tables are worth no more than their fits, and rounding adds next to nothing to that.
    fits = {"ps": 0.16, "g": 0.14, "q": 0.0107, "r": 1.4e-3, "velvet": 5e-4}
    assert result.integral.largest <= {**fits, CLOSED_FORM: EXACT_ERROR}[name]


def test_a_trial_has_the_corners_and_fixed_points_of_the_domain():
    points = trial("ps", "float").points
    assert points.shape == (81 + 2**11, 4)
    np.testing.assert_array_equal(points[:81], corners(resolve("ps").axes))
    np.testing.assert_array_equal(points, trial_of(resolve("ps"), "float", 11).points)
    assert set(points[:81, 3]) == {0.0, np.pi / 2, np.pi}
    assert points[:, 0].min() == 0.15 and points[:, 1].max() == np.pi / 2
    # Exact values of R are slow: few points have them.
    assert trial("r", "float").exact_points == 2**12


def hard_points():
    """Return (α, θf, θu, φ) where float32 is hardest: u along t and n, grazing, coplanar."""
    alpha = np.concatenate([np.geomspace(0.05, 1, 25), [1 - 2.0**-24, 1 - 1e-4]])
    theta_f = np.array([0.0, 1e-4, 0.1, 0.7, np.pi / 2 - 1e-4, np.pi / 2])
    theta_u = np.array([0.0, 1e-4, 0.1, 0.7, 1.5, np.pi / 2 - 1e-3, np.pi / 2 - 1e-6, np.pi / 2])
    phi = np.array([0.0, 1e-3, np.pi / 2, np.pi - 1e-3, np.pi])
    mesh = np.meshgrid(alpha, theta_f, theta_u, phi, indexing="ij")
    return np.stack([each.ravel() for each in mesh], axis=1)


def closed_form_in_c(points: np.ndarray):
    """Run the closed form's float32 C at points; return the trial and the values."""
    needs("c")
    at = replace(trial(CLOSED_FORM, "float", 4), points=points)
    return at, run_code(at, "c", write_source(at.calls.functions, "c"))


def test_the_closed_form_in_float_is_exact_to_3e_minus_6_everywhere():
    points = np.concatenate([corners(resolve(CLOSED_FORM).axes), hard_points()])
    hard, values = closed_form_in_c(points)
    assert np.isfinite(values).all()
    assert np.abs(values - hard.integral).max() <= EXACT_ERROR
    assert values.min() >= -EXACT_ERROR and values.max() <= 1 + EXACT_ERROR


def test_the_closed_form_is_a_number_for_every_alpha():
    points = hard_points()
    points[:, 0] = np.geomspace(1e-30, 1, len(points))
    tiny, values = closed_form_in_c(points)
    # Below α ~ 1e-3 the cosines, rounded to float, are no longer those of a direction, and P_s may
    # leave [0, 1] with them, in float64 too. What the code adds to that is small.
    assert np.isfinite(values).all()
    assert difference(values, tiny.form).largest <= 1e-5 * np.abs(tiny.form).max()


@pytest.mark.parametrize(
    ("name", "before", "factor"),
    [
        # One of 162 coefficients, in its fourth digit.
        ("ps", "numerator0 = ", 1.001),
        ("g", "density < ", 0.998),
        ("q", "return ", 1.0001),
        ("r", "return ", 1.0001),
        (CLOSED_FORM, "kappa = ", 1.00001),
    ],
)
def test_a_wrong_constant_fails(monkeypatch, name, before, factor):
    needs("c")

    def tampered(*given):
        source = write_source(*given)
        start = source.index(before) + len(before)
        digits = source[start:].partition("f")[0]
        return source[:start] + repr(float(digits) * factor) + source[start + len(digits) :]

    monkeypatch.setattr(verification, "write_source", tampered)
    result = check(trial(name, "float"), "c")
    assert result.status == "failed"
    assert "allowed" in result.reason


def test_a_wrong_order_of_arguments_fails(monkeypatch):
    needs("c")
    monkeypatch.setattr(
        verification,
        "write_source",
        lambda *given: write_source(*given).replace(
            "float NdotV, float density", "float density, float NdotV"
        ),
    )
    assert check(trial("g", "float"), "c").status == "failed"


def test_what_a_language_cannot_express_is_not_checked():
    assert "no double precision" in check(trial("q", "double"), "wgsl").reason
    if toolchain("glsl").missing("double") is None:
        assert "'cos' cannot be written in GLSL" in check(trial("ps", "double"), "glsl").reason


def test_values_are_composed_of_both_functions():
    seen = []

    def run_one(called, rows):
        seen.append((called.name, rows.shape[1]))
        return np.ones((len(rows), called.result or 1))

    values = trial("ps", "float").values(run_one)
    assert seen == [("CalcFuzzPsCoeffs", 2), ("FuzzPs", 8)]
    assert (values == 1).all()


@pytest.mark.parametrize("key", LANGUAGES)
def test_any_function_of_a_user_exports(key):
    def lobe(cosine, alpha):
        return jnp.exp(-alpha * cosine) / (1.0 + cosine)

    parameters = (Parameter("NdotU", (0.0, 1.0)), Parameter("alpha", (0.0, 4.0)))
    mine = function("Lobe", parameters, lobe)
    precision = precision_of(key, None)
    source = write_source(mine, key, precision)
    assert "Lobe(" in source
    chain = toolchain(key)
    if chain.missing(precision) is None and key != "cuda":
        rows = np.random.default_rng(8).uniform(0, 1, (100, 2))
        expected = np.exp(-rows[:, 1] * rows[:, 0]) / (1 + rows[:, 0])
        given = chain.run(source, mine, rows, precision)[:, 0]
        # The device's exp is good to several units in the last place, Blender's to 1e-5.
        np.testing.assert_allclose(given, expected, rtol=2e-5)


# Operations


def test_the_operations_of_a_table_are_those_of_its_last_function():
    # Two products, two sums and a clamp.
    assert operations_of(resolve("q")) == 6
    counted = costs(resolve("ps").functions())
    assert list(counted) == ["CalcFuzzPsCoeffs", "FuzzPs"]
    assert operations_of(resolve("ps")) == counted["FuzzPs"].operations
    # Eq. (1) by hand: three products of basis functions, five with coefficients.
    assert (counted["FuzzPs"].mul, counted["FuzzPs"].add) == (8, 5)
    # Three clamps: of both cosines and of the value.
    assert counted["FuzzPs"].select == 6
    assert counted["CalcFuzzPsCoeffs"].div == 6
    (exact,) = costs(resolve(CLOSED_FORM).functions()).values()
    # One each step of the root, one each in its start, in σ² and at the end.
    assert (exact.div, exact.transcendental) == (5, 0)


def test_an_operation_count_is_written_as_text():
    counted = Cost(add=2, mul=3, sign=1)
    assert cost_text(counted) == "5 operations (2 add, 3 mul, 1 sign)"
    assert cost_text(replace(counted, fma=1)).endswith("; 1 fma possible)")


def test_the_closed_form_stands_beside_tables_of_two_functions():
    assert closed_form_beside(resolve("ps")).name == CLOSED_FORM
    assert closed_form_beside(resolve("q")) is None
    assert closed_form_beside(resolve(CLOSED_FORM)) is None


def test_programs_are_traced_once():
    entry = resolve("best/q-9")
    assert programs_of(entry) is programs_of(entry)
    assert len(programs_of(resolve("ps"))) == 2


# Source files and their headers


@pytest.fixture
def few_points(monkeypatch):
    few = functools.partial(trial_of, exponent=8)
    monkeypatch.setattr(exported_code, "trial_of", few)


def header_of(source: str, comment: str) -> str:
    """Return the header of a source file as one line."""
    head = source.partition("\n\n")[0].splitlines()
    assert all(line.startswith(comment) for line in head)
    assert max(map(len, head)) <= 100
    return " ".join(line.removeprefix(comment).strip() for line in head)


EVERY = [
    pytest.param(key, kind, marks=[] if kind == precision_of(key, None) else [pytest.mark.slow])
    for key, spelled in LANGUAGES.items()
    for kind in spelled.types
]


@pytest.mark.parametrize(("key", "precision"), EVERY)
def test_the_header_tells_the_measured_error_in_every_language(few_points, key, precision):
    # Q takes no function that a language may lack; nvcc takes seconds a run.
    source = source_file(resolve("q"), key, precision)
    text = header_of(source, language(key).comment)
    for label in ("Quantity", "Equation", "Domain", "Error in exact arithmetic", "Cost"):
        assert f"{label}: " in text
    assert f"Made by: shadefit export q --to {key} --precision {precision}" in text
    measured = re.search(rf"Error in {precision}: rms (\S+), largest (\S+) against", text)
    # As `shadefit compare` has it, within the few points that are used here.
    assert float(measured[1]) == pytest.approx(4.7e-3, rel=0.2)
    assert float(measured[2]) == pytest.approx(1.0e-2, rel=0.1)
    ran = toolchain(key).missing(precision) is None
    assert ("this code run in" in text) == ran
    assert ("emulated" in text) != ran
    assert ("Half precision: good enough" in text) == (precision == "half")
    assert ("Rounding in float: " in text) == (precision == "float")
    assert source.startswith(f"{language(key).comment} SPDX-License-Identifier: Apache-2.0\n")
    assert source.isascii()


@pytest.mark.parametrize(
    ("name", "domain"),
    [
        ("q", "density in [0, 0.5]"),
        (CLOSED_FORM, "NdotU in [0, 1], TdotU in [-1, 1], NdotT in [0, 1], alpha in [0.05, 1]"),
        (
            "published/ps",
            "alpha in [0.15, 1], thetaF in [0.1, 1.5708] rad, NdotU in [0, 1], TdotU in [-1, 1]; "
            "all others without unit",
        ),
    ],
)
def test_the_domain_in_the_header_is_that_of_the_functions_arguments(few_points, name, domain):
    lines = header_of(source_file(resolve(name), "python"), "#")
    assert f"Domain: {domain} " in f"{lines} "
    assert ("without unit" in lines) == ("rad" in domain)


@pytest.mark.parametrize("name", ["best/q-9", "velvet"])
def test_the_header_tells_what_is_proven(few_points, name):
    text = header_of(source_file(resolve(name), "python"), "#")
    assert "Proven in exact arithmetic: denominators" in text
    assert ("none above the exact value" in text) == (name == "velvet")


def test_without_a_compiler_the_error_is_emulated(few_points, monkeypatch):
    monkeypatch.setattr(Toolchain, "missing", lambda self, precision: "not here")
    text = header_of(source_file(resolve("q"), "hlsl"), "//")
    assert "emulated, every operation rounded: HLSL was not run" in text


def test_with_a_compiler_that_fails_the_error_is_emulated(few_points, monkeypatch, tmp_path):
    compiler = tmp_path / "gcc"
    compiler.write_text("#!/bin/sh\nexit 1\n")
    compiler.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path), prepend=os.pathsep)
    assert (
        "emulated, every operation rounded: "
        "C code of FuzzAveragePenetration in float does not compile (status 1))"
    ) in " ".join(source_file(resolve("q"), "c").replace("//", "").split())


# Without coefficients, both ways to write constants are the same for all closed forms.
@pytest.mark.parametrize(
    ("name", "constants"),
    [
        *(("g", "inline"), ("g", "table"), ("exact/ps", "table"), ("exact/velvet", "inline")),
        pytest.param("exact/ps", "inline", marks=pytest.mark.slow),
        pytest.param("exact/velvet", "table", marks=pytest.mark.slow),
    ],
)
def test_the_same_call_gives_the_same_bytes(few_points, name, constants):
    first, second = (
        source_file(resolve(name), "python", "float", "Fn", constants) for _ in range(2)
    )
    assert first == second
    assert "def Fn(" in first
    if name != "exact/velvet":
        assert ("coefficients = (" in first) == (constants == "table" and name == "g")
    made_by = f"shadefit export {name} --to python --precision float --name Fn"
    assert made_by in header_of(first, "#")


@pytest.mark.slow
def test_the_header_says_when_half_is_not_good_enough(few_points):
    """The verdict is that of `shadefit verify`, and a table's own error does not matter."""
    text = header_of(source_file(resolve("published/ps"), "python", "half"), "#")
    assert re.search(r"NOT GOOD ENOUGH: rounding moves .* allowed: 0.02, 2% of the largest", text)
    assert check(trial("published/ps", "half"), "python").status == "not good enough"
    for name in ("q", "published/g", CLOSED_FORM):
        assert "NOT GOOD ENOUGH" not in source_file(resolve(name), "python", "half")
        assert check(trial(name, "half"), "python").status == "passed"
    assert "precision: " not in source_file(resolve("q"), "python", "float")


@pytest.mark.parametrize(("precision", "most"), [("float", 2e-7), ("double", 4e-15)])
def test_the_header_of_a_closed_form_says_what_its_steps_leave(few_points, precision, most):
    text = header_of(source_file(resolve(CLOSED_FORM), "python", precision), "#")
    left = re.search(r"none but what the root's steps leave: rms (\S+), largest (\S+) ", text)
    assert 0 < float(left[1]) < float(left[2]) < most


def test_other_closed_forms_have_no_steps(few_points):
    text = header_of(source_file(resolve("exact/velvet"), "python"), "#")
    assert "the root's steps" not in text
    assert "Error in exact arithmetic: none" in text


@pytest.mark.parametrize(
    ("key", "precision", "name", "message"),
    [
        ("fortran", None, None, "allowed: c, cpp"),
        ("wgsl", "double", None, "allowed: half, float"),
        ("c", None, "2x", "no identifier"),
        ("hlsl", None, "float3", "cannot be used in HLSL"),
        ("glsl", None, "gl_x", "cannot be used in GLSL"),
    ],
)
def test_what_cannot_be_written_is_refused_before_anything_is_measured(
    monkeypatch, key, precision, name, message
):
    monkeypatch.setattr(code_header, "judge", None)
    monkeypatch.setattr(exported_code, "trial_of", None)
    with pytest.raises(ValueError, match=message):
        source_file(resolve("q"), key, precision, name)
