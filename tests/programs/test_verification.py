"""Verification: right code passes, wrong code fails, and what cannot run is not checked."""

import re

import jax.numpy as jnp
import numpy as np
import pytest

from programs.functions import Parameter, function
from programs.languages import LANGUAGES, precision_of
from programs.printing.printer import write_source
from programs.toolchains import ToolchainError, toolchain, verification
from programs.toolchains.difference import Difference, difference, text_of, two_digits
from programs.toolchains.half_precision import verdict
from programs.toolchains.interface import Toolchain
from programs.toolchains.verification import CallSequence, Trial, check, corners, run_code

UNIT = (0.0, 1.0)
WAVE = function(
    "Wave",
    [Parameter("alpha", UNIT), Parameter("theta", UNIT, "rad")],
    lambda alpha, theta: 0.7391 * jnp.cos(theta) / (1.0 + alpha * alpha),
)
MATERIAL = function("Material", [Parameter("alpha", UNIT)], lambda a: (a * a, 1.0 - a), "", 2, "c")
DIRECTION = function(
    "Direction",
    [Parameter("c", UNIT, size=2), Parameter("cosine", UNIT)],
    lambda c, x: c[0] + 0.3719 * c[1] * x,
)
POLE = function("Pole", [Parameter("x", UNIT)], lambda x: 1.0 / (1.0002 - x))
ONE = CallSequence((WAVE,), lambda points: (points,))
TWO = CallSequence((MATERIAL, DIRECTION), lambda points: (points[:, :1], np.cos(points[:, 1:])))
BOTH = function(
    "Both",
    [Parameter("alpha", UNIT), Parameter("theta", UNIT, "rad")],
    lambda alpha, theta: (0.0 * alpha, 0.7391 * jnp.cos(theta) / (1.0 + alpha * alpha)),
    "",
    2,
    "both",
)
SEVERAL = CallSequence((BOTH,), lambda points: (points,))
NEAR_POLE = CallSequence((POLE,), lambda points: (points[:, :1],))
POINTS = np.random.default_rng(5).random((500, 2))


def exact_wave(points):
    alpha, theta = points.T
    return 0.74 * np.cos(theta) / (1 + alpha**2)


def needs(language: str, precision: str = "float") -> None:
    reason = toolchain(language).missing(precision)
    if reason is not None:
        pytest.skip(reason)


# Every language in its default precision; nvcc takes seconds.
@pytest.mark.parametrize("language", [key for key in LANGUAGES if key != "cuda"])
@pytest.mark.parametrize("calls", [ONE, TWO], ids=["one function", "two functions"])
def test_printed_code_passes_in_every_language(calls, language):
    precision = precision_of(language, None)
    needs(language, precision)
    result = check(Trial(calls, POINTS, precision), language)
    assert (result.status, result.reason) == ("passed", None)
    assert (result.language, result.precision, result.points) == (language, precision, 500)
    assert result.form.within(result.allowed)
    assert result.tool and result.note
    # Without exact values nothing is said of them.
    assert result.integral is None and result.integral_points == 0


@pytest.mark.parametrize("precision", ["half", "float", "double"])
def test_the_difference_in_units_is_that_of_the_precision(precision):
    result = check(Trial(ONE, POINTS, precision), "python")
    assert result.status == "passed"
    if precision == "double":
        assert result.form == Difference(0.0, 0.0)
    else:
        eps = float(np.finfo(verification.PRECISIONS[precision]).eps)
        assert 0.1 * eps < result.form.largest < 4 * eps
        assert 0.4 < result.units.largest < 8


def test_several_values_are_compared_one_by_one(monkeypatch):
    def exact(points):
        return np.stack([np.zeros(len(points)), exact_wave(points)], axis=1)

    trial = Trial(SEVERAL, POINTS, "float", exact, 200)
    assert trial.form.shape == (1000,) and trial.integral_points == 200
    result = check(trial, "python")
    assert (result.status, result.points, result.integral_points) == ("passed", 500, 200)
    assert 5e-4 < result.integral.largest < 1e-3
    # A value of zero is compared in units of the largest value at its point.
    assert result.units.largest < 8
    one = check(Trial(ONE, POINTS, "float"), "python")
    np.testing.assert_allclose(result.form.largest, one.form.largest, rtol=1e-15)
    source = write_source(SEVERAL.functions, "python")
    changed = re.sub(r"0\.739\d?\b", "0.7392", source)
    assert changed != source
    monkeypatch.setattr(verification, "write_source", lambda *_: changed)
    assert check(trial, "python").status == "failed"


def test_half_precision_of_several_values_is_judged_by_the_worst():
    apart = difference(np.zeros(1), np.zeros(1))
    several = verdict(Trial(SEVERAL, POINTS, "half"), apart)
    assert several == verdict(Trial(ONE, POINTS, "half"), apart)


@pytest.mark.parametrize("precision", ["half", "float", "double"])
def test_a_constant_that_is_slightly_wrong_fails(monkeypatch, precision):
    wrong = {"half": "0.7491", "float": "0.739101", "double": "0.739100000000001"}[precision]

    def tampered(*arguments):
        source = write_source(*arguments)
        changed = re.sub(r"0\.739\d?\b", wrong, source)
        assert changed != source
        return changed

    monkeypatch.setattr(verification, "write_source", tampered)
    result = check(Trial(ONE, POINTS, precision), "python")
    assert result.status == "failed"
    assert re.fullmatch(
        r"differs from the float64 form by rms .*, largest .*; allowed: rms .*, largest .*",
        result.reason,
    )


def test_arguments_in_the_wrong_order_fail(monkeypatch):
    monkeypatch.setattr(
        verification,
        "write_source",
        lambda *arguments: write_source(*arguments).replace("(alpha, theta)", "(theta, alpha)"),
    )
    assert check(Trial(ONE, POINTS, "float"), "python").status == "failed"


def test_code_that_does_not_compile_fails(monkeypatch):
    needs("c")
    monkeypatch.setattr(verification, "write_source", lambda *_: "float Wave(float a) { nonsense }")
    result = check(Trial(ONE, POINTS, "float"), "c")
    assert result.status == "failed"
    assert "does not compile" in result.reason
    assert result.tool and result.form is None


def test_values_that_are_not_finite_fail(monkeypatch):
    monkeypatch.setattr(
        verification,
        "write_source",
        lambda *_: (
            "import numpy as np\n"
            "def Wave(alpha, theta):\n    return np.sqrt(-np.float32(1) - alpha)"
        ),
    )
    result = check(Trial(ONE, POINTS, "float"), "python")
    assert result.status == "failed"
    assert result.form == Difference(0.0, 0.0, len(POINTS))
    assert "500 values not finite" in result.reason


def test_a_missing_compiler_is_not_checked(monkeypatch):
    monkeypatch.setattr(Toolchain, "missing", lambda self, precision: "gcc is not on PATH")
    result = check(Trial(ONE, POINTS, "float"), "c")
    assert (result.status, result.reason) == ("not checked", "gcc is not on PATH")
    assert result.form is None and result.points == 0


def test_what_a_language_cannot_express_is_not_checked(monkeypatch):
    result = check(Trial(ONE, POINTS, "double"), "wgsl")
    assert (result.status, result.reason) == ("not checked", "WGSL has no double precision")
    monkeypatch.setattr(Toolchain, "missing", lambda self, precision: None)
    result = check(Trial(ONE, POINTS, "double"), "glsl")
    assert result.status == "not checked"
    assert result.reason.startswith("'cos' cannot be written in GLSL at double precision; allowed:")


def test_an_unknown_language_is_refused():
    with pytest.raises(ValueError, match="target 'klingon' is unknown; allowed: c, cpp, "):
        check(Trial(ONE, POINTS, "float"), "klingon")


@pytest.mark.parametrize("precision", ["quad", ""])
def test_an_unknown_precision_is_refused(precision):
    with pytest.raises(ValueError, match=f"precision is '{precision}'; allowed: half, float, doub"):
        Trial(ONE, POINTS, precision)


def test_a_function_that_cannot_be_traced_is_refused_at_once():
    broken = function("Broken", [Parameter("x", UNIT)], lambda x: jnp.sort(jnp.stack([x, -x]))[0])
    with pytest.raises(ValueError, match="'sort' in Broken"):
        Trial(CallSequence((broken,), lambda points: (points,)), POINTS, "float")


def test_each_function_gets_the_results_of_the_one_before_it_and_its_own_columns():
    seen = []

    def run(called, rows):
        seen.append((called.name, rows))
        return np.full((len(rows), called.result or 1), 0.25 * len(seen))

    values = Trial(TWO, POINTS, "half").values(run)
    assert [name for name, _ in seen] == ["Material", "Direction"]
    half = POINTS[:, :1].astype(np.float16).astype(float)
    np.testing.assert_array_equal(seen[0][1], half)
    cosines = np.cos(POINTS[:, 1:]).astype(np.float16).astype(float)
    np.testing.assert_array_equal(seen[1][1], np.hstack([np.full((500, 2), 0.25), cosines]))
    assert (values == 0.5).all()


def test_a_row_that_is_not_finite_is_not_run():
    def run(called, rows):
        assert np.isfinite(rows).all()
        results = np.ones((len(rows), called.result or 1))
        if called is MATERIAL:
            results[3, 1] = np.inf
        return results

    values = Trial(TWO, POINTS, "float").values(run)
    assert np.isnan(values[3]) and (np.delete(values, 3) == 1).all()


def test_the_allowed_difference_is_eight_times_that_of_correct_rounding():
    trial = Trial(ONE, POINTS, "float")
    rounding = difference(trial.emulated(np.float32), trial.form)
    eps = float(np.finfo(np.float32).eps)
    assert 0 < rounding.largest < 1e-6
    assert trial.allowed.largest == 8 * rounding.largest
    assert trial.allowed.rms == max(8 * rounding.rms, 4 * eps * np.abs(trial.form).max())


def test_the_allowed_difference_in_double_is_that_of_float_at_the_same_points_scaled():
    # At these points, which are not those of any default, float rounding errors are large.
    points = 1.0001 - np.geomspace(1e-4, 1e-3, 50)[:, None]
    single, double = (Trial(NEAR_POLE, points, each) for each in ("float", "double"))
    scale = float(np.finfo(np.float64).eps / np.finfo(np.float32).eps)
    rounding = difference(single.emulated(np.float32), single.form)
    assert double.allowed.largest == 8.0 * scale * rounding.largest
    assert double.allowed.largest > 100 * np.finfo(float).eps * np.abs(double.form).max()


def test_a_function_that_is_exact_in_numpy_is_allowed_a_few_units():
    doubled = function("Doubled", [Parameter("x", UNIT)], lambda x: 2.0 * x)
    trial = Trial(CallSequence((doubled,), lambda p: (p[:, :1],)), np.array([[0.5]]), "float")
    assert trial.allowed == Difference(*[4 * float(np.finfo(np.float32).eps)] * 2, 0)


def test_values_near_a_pole_may_be_lost_eight_times_as_often_as_by_correct_rounding():
    points = np.linspace(0, 1, 4001)[:, None]
    half = Trial(NEAR_POLE, points, "half")
    lost = difference(half.emulated(np.float16), half.form).not_finite
    assert lost > 0
    assert half.allowed.not_finite == 8 * lost
    single = Trial(NEAR_POLE, points, "float")
    assert difference(single.emulated(np.float32), single.form).not_finite == 0


def test_exact_values_are_compared_at_the_points_before_rounding():
    seen = []

    def exact(points):
        seen.append(points)
        return exact_wave(points)

    result = check(Trial(ONE, POINTS, "half", exact), "python")
    np.testing.assert_array_equal(seen[0], POINTS)
    assert result.status == "passed"
    assert result.integral_points == len(POINTS)
    # 0.7391 instead of 0.74: an error of the function, not of its code
    assert 9e-4 < result.integral.largest < 3e-3
    assert result.form.largest < 2e-3


def test_exact_values_can_be_limited_to_the_first_points():
    shapes = []

    def exact(points):
        shapes.append(points.shape)
        return exact_wave(points)

    trial = Trial(ONE, POINTS, "float", exact, 7)
    assert check(trial, "python").integral_points == 7
    assert shapes == [(7, 2)]
    expected = difference(trial.form[:7], exact_wave(POINTS[:7]))
    assert trial.against_integral(trial.form) == expected
    assert 0 < expected.largest < 1e-3


def test_a_comparison_without_exact_values_is_refused():
    trial = Trial(ONE, POINTS, "float")
    with pytest.raises(ValueError, match="exact is None"):
        trial.against_integral(trial.form)


def test_code_of_another_function_does_not_run():
    with pytest.raises(ToolchainError, match="no function Wave"):
        run_code(Trial(ONE, POINTS, "float"), "python", write_source(POLE, "python"))


class Side:
    def __init__(self, lower, upper, period=None):
        self.lower, self.upper, self.period = lower, upper, period


def test_corners_are_ends_and_middles_and_of_an_angle_three_directions():
    points = corners([Side(0.15, 1.0), Side(0.0, np.pi / 2), Side(-np.pi, np.pi, 2 * np.pi)])
    assert points.shape == (27, 3)
    assert set(points[:, 0]) == {0.15, 0.575, 1.0}
    assert set(points[:, 1]) == {0.0, np.pi / 4, np.pi / 2}
    assert set(points[:, 2]) == {0.0, np.pi / 2, np.pi}
    assert len({tuple(point) for point in points}) == 27
    # The period counts, not the length of the axis.
    assert set(corners([Side(0.0, 10.0)])[:, 0]) == {0.0, 5.0, 10.0}


def test_differences_count_values_that_are_not_finite_apart():
    apart = difference(np.array([1.0, 3.0, np.nan]), np.array([1.0, 2.0, 0.0]))
    assert apart == Difference(1.0, np.sqrt(0.5), 1)
    assert difference(np.array([1.5]), np.array([1.0]), np.array([0.25])).largest == 2.0
    assert difference(np.array([np.inf]), np.array([1.0])) == Difference(0.0, 0.0, 1)


@pytest.mark.parametrize(
    ("larger", "within"),
    [
        (Difference(1.0, 0.5, 1), True),
        (Difference(2.0, 2.0, 2), True),
        (Difference(0.9, 0.5, 1), False),
        (Difference(1.0, 0.4, 1), False),
        (Difference(1.0, 0.5, 0), False),
    ],
)
def test_a_difference_is_within_another_in_every_field(larger, within):
    assert Difference(1.0, 0.5, 1).within(larger) == within


def test_a_difference_is_written_with_two_digits():
    assert text_of(Difference(0.0123, 4.56e-7)) == "rms 4.6e-07, largest 1.3e-02"
    assert text_of(Difference(1.0, 0.5, 3)) == "rms 5.0e-01, largest 1.0e+00, 3 values not finite"


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.13323, "1.4e-01"), (0.13, "1.3e-01"), (0.991, "1.0e+00"), (0.0, "0.0e+00"),
        (2.00001e-7, "2.1e-07"), (9.95e-5, "1.0e-04"), (5e-5, "5.0e-05"), (12.01, "1.3e+01"),
    ],
)  # fmt: skip
def test_stated_errors_are_rounded_up(value, text):
    assert two_digits(value) == text


def test_half_is_good_enough_if_rounding_moves_no_value_far():
    coarse = function("Coarse", [Parameter("x", (0.0, 1.0))], lambda x: (x + 300.0) - 300.0)
    points = np.linspace(0, 1, 65)[:, None]
    result = check(Trial(CallSequence((coarse,), lambda rows: (rows,)), points, "half"), "python")
    assert result.status == "not good enough"
    assert "allowed: 0.02, 2% of the largest value" in result.reason
    fine = function("Fine", [Parameter("x", (0.0, 1.0))], lambda x: (x + 1.0) * 0.25)
    calls = CallSequence((fine,), lambda rows: (rows,))
    assert check(Trial(calls, points, "half"), "python").status == "passed"
