"""Exported code against its form: right code passes, wrong code fails, absent tools are said."""

import functools
import json

import numpy as np
import pytest

from coefficients import verify
from coefficients.shaders import EXACT_PS, Shader, exact_ps, shader
from coefficients.verify import Check, Difference, Problem, check, corners, difference, precision_of
from integrals import PS
from programs.function import Parameter, function
from programs.languages import PRECISIONS, TARGETS
from programs.printing.printer import write
from programs.toolchains import ToolchainError
from programs.toolchains.registry import toolchain
from programs.toolchains.toolchain import Toolchain
from shadefit.cli import main

NAMES = ["ps", "g", "q", "r", "velvet", EXACT_PS]
# Every language in the precision that it is written in by default, and the closed form, which needs
# nothing that a language may lack, in all of them. nvcc takes seconds a function.
CASES = [
    (name, language, precision)
    for name in NAMES
    for language, spelled in TARGETS.items()
    for precision in spelled.types
    if (name == EXACT_PS or precision == precision_of(language, None))
    and (language != "cuda" or (name in ("ps", EXACT_PS) and precision == "float"))
] + [("ps", "c", "half"), ("ps", "wgsl", "half"), ("r", "wgsl", "half")]
# In float32 over α from 0.05 to 1: what the closed form is exported for.
EXACT_ERROR = 3e-6


@functools.cache
def problem(name, precision, exponent=11):
    return Problem(shader(name, precision), precision, exponent)


@pytest.mark.parametrize(("name", "language", "precision"), CASES)
def test_every_language_passes_or_is_not_checked(name, language, precision):
    result = check(problem(name, precision), language)
    if result.status == "not checked":
        assert result.reason and result.form is None
        assert language not in ("c", "cpp", "python", "javascript"), result.reason
        pytest.skip(result.reason)
    assert result.status == "passed", result.reason
    assert result.points == len(problem(name, precision).points)
    assert result.form.largest <= result.allowed.largest
    assert result.tool and result.note


@pytest.mark.parametrize("name", NAMES)
def test_a_hundred_thousand_points_and_the_corners(name):
    result = check(problem(name, "float", verify.EXPONENT), "c")
    assert result.status == "passed", result.reason
    assert result.points >= 100_000
    # The tables are worth no more than their fits, and rounding adds next to nothing to that.
    fits = {"ps": 0.16, "g": 0.14, "q": 0.0107, "r": 1.4e-3, "velvet": 5e-4, EXACT_PS: EXACT_ERROR}
    assert result.integral.largest <= fits[name]


def hard_points():
    """Give (α, θf, θu, φ) where float32 is hardest: u along t and n, grazing, coplanar."""
    alpha = np.concatenate([np.geomspace(0.05, 1, 25), [1 - 2.0**-24, 1 - 1e-4]])
    theta_f = np.array([0.0, 1e-4, 0.1, 0.7, np.pi / 2 - 1e-4, np.pi / 2])
    theta_u = np.array([0.0, 1e-4, 0.1, 0.7, 1.5, np.pi / 2 - 1e-3, np.pi / 2 - 1e-6, np.pi / 2])
    phi = np.array([0.0, 1e-3, np.pi / 2, np.pi - 1e-3, np.pi])
    mesh = np.meshgrid(alpha, theta_f, theta_u, phi, indexing="ij")
    return np.stack([each.ravel() for each in mesh], axis=1)


def test_the_closed_form_in_float_is_exact_to_3e_minus_6_everywhere():
    if toolchain("c").missing("float") is not None:
        pytest.skip("gcc is not here")
    hard = Problem(shader(EXACT_PS), "float", 4)
    hard.points = np.concatenate([corners(hard.shader.axes), hard_points()])
    values = verify.run_code(hard, "c", write(hard.shader.functions, "c"))
    assert np.isfinite(values).all()
    assert np.abs(values - hard.integral).max() <= EXACT_ERROR
    assert values.min() >= -EXACT_ERROR and values.max() <= 1 + EXACT_ERROR


def test_the_closed_form_is_a_number_for_every_alpha():
    if toolchain("c").missing("float") is not None:
        pytest.skip("gcc is not here")
    tiny = Problem(shader(EXACT_PS), "float", 4)
    points = hard_points()
    points[:, 0] = np.geomspace(1e-30, 1, len(points))
    tiny.points = points
    values = verify.run_code(tiny, "c", write(tiny.shader.functions, "c"))
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
        (EXACT_PS, "return ", 1.00001),
    ],
)
def test_a_wrong_constant_fails(monkeypatch, name, before, factor):
    write = verify.write

    def tampered(*given):
        source = write(*given)
        start = source.index(before) + len(before)
        digits = source[start:].partition("f")[0]
        return source[:start] + repr(float(digits) * factor) + source[start + len(digits) :]

    monkeypatch.setattr(verify, "write", tampered)
    result = check(problem(name, "float"), "c")
    assert result.status == "failed"
    assert "allowed" in result.reason


def test_an_order_of_arguments_that_is_wrong_fails(monkeypatch):
    write = verify.write
    monkeypatch.setattr(
        verify,
        "write",
        lambda *given: write(*given).replace(
            "float NdotV, float density", "float density, float NdotV"
        ),
    )
    assert check(problem("g", "float"), "c").status == "failed"


def test_code_that_does_not_compile_fails(monkeypatch):
    monkeypatch.setattr(verify, "write", lambda *given: "float FuzzGApprox(float a) { nonsense }")
    result = check(problem("g", "float"), "c")
    assert result.status == "failed"
    assert "does not compile" in result.reason
    assert result.tool


def test_values_that_are_not_finite_fail(monkeypatch):
    monkeypatch.setattr(
        verify,
        "write",
        lambda *given: (
            "#include <math.h>\nfloat FuzzAveragePenetration(float d) { return sqrtf(-1.0f - d); }"
        ),
    )
    result = check(problem("q", "float"), "c")
    assert result.status == "failed"
    assert result.form.not_finite == result.points


def test_a_missing_compiler_is_not_checked_and_never_passed(monkeypatch, capsys):
    monkeypatch.setattr(Toolchain, "missing", lambda self, precision: "gcc is not on PATH")
    result = check(problem("q", "float"), "c")
    assert (result.status, result.reason) == ("not checked", "gcc is not on PATH")
    status, out, _ = run(capsys, "verify", "q", "--to", "c")
    assert status == 0
    assert "not checked" in out and "passed" not in out


def test_what_a_language_cannot_say_is_not_checked():
    assert "no double precision" in check(problem("q", "double"), "wgsl").reason
    if toolchain("glsl").missing("double") is None:
        assert "'cos' cannot be written in GLSL" in check(problem("ps", "double"), "glsl").reason


def test_the_values_are_composed_of_both_functions():
    seen = []

    def run_one(function, rows):
        seen.append((function.name, rows.shape[1]))
        return np.ones((len(rows), function.result or 1))

    values = problem("ps", "float").values(run_one)
    assert seen == [("CalcFuzzPsCoeffs", 2), ("FuzzPs", 8)]
    assert (values == 1).all()


def test_what_is_allowed_is_eight_times_correct_rounding():
    of_float = problem("g", "float")
    emulated = difference(of_float.emulated(np.float32), of_float.form)
    assert of_float.allowed.largest == verify.SLACK * emulated.largest
    assert 0 < emulated.largest < 1e-5
    # In double the same operations round 2²⁹ times less.
    assert problem("g", "double").allowed.largest < 1e-13


def test_a_value_near_a_pole_may_be_lost_as_often_as_correct_rounding_loses_it():
    near = Shader(
        "A pole",
        "1/(x − 1)",
        PS,
        (PS.axes[1],),
        (function("Pole", (Parameter("x", (0.0, 1.0)),), lambda x: 1.0 / (1.0002 - x)),),
        lambda points: (points / np.pi * 2,),
    )
    lossy = Problem(near, "half", 12)
    lost = difference(lossy.emulated(np.float16), lossy.form).not_finite
    assert lost > 0
    assert lossy.allowed.not_finite == verify.SLACK * lost
    single = Problem(near, "float", 12)
    assert difference(single.emulated(np.float32), single.form).not_finite == 0


def test_corners_are_the_ends_and_middles():
    points = corners(shader("ps").axes)
    assert points.shape == (81, 4)
    assert set(points[:, 3]) == {0.0, np.pi / 2, np.pi}
    assert points[:, 0].min() == 0.15 and points[:, 1].max() == np.pi / 2


def test_differences():
    apart = difference(np.array([1.0, 3.0, np.nan]), np.array([1.0, 2.0, 0.0]))
    assert apart == Difference(1.0, np.sqrt(0.5), 1)
    assert difference(np.array([1.5]), np.array([1.0]), np.array([0.25])).largest == 2.0
    assert not apart.within(Difference(1.0, 1.0, 0))
    assert apart.within(Difference(1.0, 1.0, 1))
    assert difference(np.array([np.inf]), np.array([1.0])) == Difference(0.0, 0.0, 1)


@pytest.mark.parametrize("precision", ["quad", ""])
def test_an_unknown_precision_is_refused(precision):
    with pytest.raises(ValueError, match="allowed: half, float, double"):
        Problem(shader("q"), precision)


def run(capsys, *arguments):
    with pytest.raises(SystemExit) as stopped:
        main(list(arguments))
    captured = capsys.readouterr()
    return stopped.value.code, captured.out, captured.err


def test_verify_prints_a_row_a_language(capsys):
    status, out, _ = run(capsys, "verify", "q", "--to", "python", "--precision", "all", "--json")
    assert status == 0
    rows = json.loads(out)["tables"]["q"]
    assert [row["precision"] for row in rows] == list(PRECISIONS)
    assert all(row["status"] == "passed" and row["points"] >= 100_000 for row in rows)
    status, out, _ = run(capsys, "verify", "q", "--to", "javascript")
    assert status == 0
    assert "passed" in out and "Node" in out


def test_verify_says_by_its_status_that_something_failed(capsys, monkeypatch):
    def broken(*given):
        raise ToolchainError("does not run")

    monkeypatch.setattr(verify, "run_code", broken)
    status, out, _ = run(capsys, "verify", "q", "--to", "python")
    assert status == 1
    assert "failed: does not run" in out


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["verify", "q", "--to", "fortran"], "allowed: c, cpp"),
        (["verify", "q", "--to", "wgsl", "--precision", "double"], "allowed: half, float"),
        (["verify", "q", "--precision", "quad"], "quad"),
        (["verify", "zz"], "no table"),
        (["verify"], "tables"),
        (["export", "q", "--to", "fortran"], "allowed: c, cpp"),
        (["export", "q", "--to", "wgsl", "--precision", "double"], "allowed: half, float"),
        (["export", "ps", "--to", "glsl", "--precision", "double"], "cannot be written in GLSL"),
        (["export", "q", "--to", "c", "--name", "2x"], "no identifier"),
        (["export", "q", "--to", "hlsl", "--name", "float3"], "cannot be used in HLSL"),
        (["export", "q", "--to", "glsl", "--name", "gl_x"], "cannot be used in GLSL"),
        (["export", "q", "--precision", "half"], "allowed with --to"),
        (["export", "q", "--name", "Fn"], "allowed with --to"),
        (["export", "q", "--constants", "table"], "allowed with --to"),
        (["export", EXACT_PS], "with --to LANG"),
        (["export", "exact/g", "--to", "c"], "no closed form"),
        (["cost", "exact/q"], "no closed form"),
    ],
)
def test_bad_input_is_one_line(capsys, tmp_path, arguments, said):
    status, out, err = run(capsys, *arguments)
    assert (status, out) == (2, "")
    assert err.startswith("shadefit: ") and err.count("\n") == 1
    assert said in err


def test_export_writes_the_file_whole(capsys, tmp_path):
    path = tmp_path / "deep" / "q.py"
    assert run(capsys, "export", "q", "--to", "python", "-o", str(path))[0] == 0
    status, out, _ = run(capsys, "export", "q", "--to", "python")
    assert status == 0 and out == path.read_text()
    assert "def FuzzAveragePenetration(density):" in out


def test_cost_counts_beside_the_closed_form(capsys):
    _, out, _ = run(capsys, "cost", "ps", "--json")
    rows = {row["function"]: row for row in json.loads(out)["functions"]}
    assert list(rows) == ["CalcFuzzPsCoeffs", "FuzzPs", "FuzzPsExact"]
    assert [row["evaluated_for"] for row in rows.values()] == [
        "a material", "a direction", "a direction, exact/ps",
    ]  # fmt: skip
    # Eq. (1) by hand: three products of basis functions, five with coefficients.
    assert (rows["FuzzPs"]["mul"], rows["FuzzPs"]["add"]) == (8, 5)
    assert rows["CalcFuzzPsCoeffs"]["div"] == 6
    # One each step of the root, one each in its start, in σ² and at the end.
    assert rows["FuzzPsExact"]["div"] == 5 and rows["FuzzPsExact"]["transcendental"] == 0
    assert rows["FuzzPs"]["throughput"] is None
    assert "exact/ps" in run(capsys, "cost", "ps")[1]
    assert "No exact form" in run(capsys, "cost", "g")[1]


def test_cost_measures_throughput(capsys):
    if toolchain("c").missing("float") is not None:
        pytest.skip("gcc is not here")
    _, out, _ = run(capsys, "cost", "q", "--throughput", "--json")
    (row,) = json.loads(out)["functions"]
    assert row["throughput"]["compiled"] > 0 and row["throughput"]["jax"] > 0
    assert "million" in run(capsys, "cost", "q", "--throughput")[1]


def test_the_closed_form_takes_more_steps_in_double():
    assert len(verify.trace(exact_ps("double")[0]).steps) > len(verify.trace(exact_ps()[0]).steps)
    assert isinstance(check(problem(EXACT_PS, "double"), "python"), Check)
