"""The compiled interval arithmetic: rounding, undefined values, functions and conditions."""

import functools
import itertools
from fractions import Fraction

import jax.numpy as jnp
import mpmath
import numpy as np
import pytest

from programs.bounding import compiled
from programs.bounding.compiled import compiler_missing
from programs.bounding.largest import bound_largest
from programs.toolchains.process import ToolchainError
from tests.programs.kernels import Kernels, kernel_of, kernels_of
from tests.programs.test_loopholes import BOX, FAULTS, HIDDEN, SOUND

pytestmark = pytest.mark.skipif(compiler_missing() is not None, reason="no C compiler")

UNIT = np.array([[0.0, 1.0]])


# Rounding


@pytest.mark.parametrize("mode", ["FE_TONEAREST", "FE_DOWNWARD", "FE_TOWARDZERO"])
def test_a_processor_that_does_not_round_upward_is_noticed(mode):
    """The same code with another rounding mode: a search must not begin."""
    code = f"#include <fenv.h>\n#undef FE_UPWARD\n#define FE_UPWARD {mode}\n"
    entry = "static jet error_at(boxes *K, const jet *x) { return x[0]; }"
    kernel = compiled.compile_kernel([code, entry], 1)
    with pytest.raises(RuntimeError, match="does not round upward"):
        bound_largest(kernel, UNIT, 1.1)


def test_fused_operations_are_noticed(monkeypatch):
    flags = [flag for flag in compiled._FLAGS if "contract" not in flag]
    monkeypatch.setattr(compiled, "_FLAGS", (*flags, "-ffp-contract=fast", "-mfma"))
    try:
        kernel = kernel_of(lambda x: x * x - x)
        found = bound_largest(kernel, UNIT, 1.1)
    except ToolchainError:
        pytest.skip("this processor's compiler has no fused multiply-add")
    except RuntimeError:
        return
    pytest.fail(f"fused operations were not noticed: {found}")


def test_approximate_operations_are_noticed(monkeypatch):
    """-ffast-math replaces quotients by products, and forgets NaN and the rounding mode.

    These are its parts but one: a library that is linked with it flushes denormals to zero in the
    whole process, so that other tests would fail.
    """
    flags = ("-freciprocal-math", "-fassociative-math", "-fno-signed-zeros", "-fno-trapping-math")
    flags += ("-ffinite-math-only", "-fno-rounding-math")
    monkeypatch.setattr(compiled, "_FLAGS", (*compiled._FLAGS, *flags))
    kernel = kernel_of(lambda x: x / 3 - x * x)
    with pytest.raises(RuntimeError, match="does not round upward"):
        bound_largest(kernel, UNIT, 1.1)


CONSTANTS = {
    "LN2": lambda: mpmath.ln(2),
    "iadd(number(LN2_FIRST), LN2_REST)": lambda: mpmath.ln(2),
    "HALF_PI": lambda: mpmath.pi / 2,
    "iadd(number(HALF_PI_FIRST), iadd(number(HALF_PI_SECOND), HALF_PI_REST))": lambda: (
        mpmath.pi / 2
    ),
    "ireciprocal(number(3))": lambda: mpmath.mpf(1) / 3,
    "over_odd(7)": lambda: mpmath.mpf(1) / 7,
    "ireciprocal(HALF_PI)": lambda: 2 / mpmath.pi,
}


def test_constants_without_a_float_are_intervals():
    cases = " ".join(f"case {k}: y = {text}; break;" for k, text in enumerate(CONSTANTS))
    code = f"""
static int place; void choose_place(int k) {{ place = k; }}
static jet error_at(boxes *K UNUSED, const jet *x UNUSED) {{
    iv y = number(0);
    switch (place) {{ {cases} }}
    return constant(y);
}}"""
    kernel = compiled.compile_kernel([code], 1)
    with mpmath.workdps(50):
        for k, exact in enumerate(CONSTANTS.values()):
            kernel.library.choose_place(k)
            low, high, *_ = kernel.enclose(UNIT)
            assert mpmath.mpf(low) < exact() < mpmath.mpf(high)
            # At most three neighbouring numbers
            assert high <= np.nextafter(np.nextafter(low, 9), 9)


def test_numbers_below_the_smallest_normal_one_are_kept():
    """A product of two numbers may be so small that only an upper bound above zero is right."""
    kernel = kernel_of(lambda x: (x * 1e-160) * (x * 1e-160))
    low, high, *_ = kernel.enclose(np.array([[0.5, 0.5]]))
    assert low <= 0.25e-320 <= high and 0 < high < 1e-310


def test_code_that_does_not_compile_is_an_error_of_the_toolchain():
    with pytest.raises(ToolchainError, match="does not compile"):
        compiled.compile_kernel(["not C;"], 1)


def test_the_rounding_mode_is_restored():
    bound_largest(kernel_of(lambda x: x * (1 - x)), UNIT, 1.1)
    assert np.float64(1) + np.float64(2**-60) == 1
    assert -np.float64(1) / np.float64(3) == -(np.float64(1) / np.float64(3))


ARITHMETIC = {
    "sum": (lambda x, y: x + y, lambda x, y: x + y),
    "difference": (lambda x, y: x - y, lambda x, y: x - y),
    "product": (lambda x, y: x * y, lambda x, y: x * y),
    "quotient": (lambda x, y: x / y, lambda x, y: x / y),
    "square": (lambda x, y: x * x, lambda x, y: x * x),
    "constant": (lambda x, y: 0.1 * x + 0.7, lambda x, y: Fraction(0.1) * x + Fraction(0.7)),
    "constant divisor": (
        lambda x, y: (x - 0.3) / 0.7,
        lambda x, y: (x - Fraction(0.3)) / Fraction(0.7),
    ),
    "third": (lambda x, y: x / 3 + y, lambda x, y: x / 3 + y),
    "inverse": (lambda x, y: 0.3 / y, lambda x, y: Fraction(0.3) / y),
}


@functools.cache
def arithmetic() -> Kernels:
    return kernels_of({name: call for name, (call, _) in ARITHMETIC.items()}, 2)


@pytest.mark.parametrize("name", ARITHMETIC)
def test_operations_are_rounded_outwards_and_by_no_more_than_rounding(name):
    """Exact fractions decide. A bound of the wrong side by half a unit would be found."""
    rng = np.random.default_rng(3)
    inexact = 0
    for _ in range(300):
        x, y = rng.uniform(-2, 2, 2) * 10.0 ** rng.integers(-3, 4, 2)
        exact = ARITHMETIC[name][1](Fraction(x), Fraction(y))
        low, high, *centre = arithmetic()(name, [x, y], [x, y])
        assert low <= exact <= high
        assert centre[0] <= exact <= centre[1]
        # Sums of two roundings may cancel by a few digits.
        assert high - low <= 1e-12 * max(abs(float(exact)), 1e-3)
        inexact += low < high
    assert inexact > 100


def test_corners_of_a_box_are_inside_its_bounds():
    rng = np.random.default_rng(4)
    for name in ARITHMETIC:
        for _ in range(50):
            low = rng.uniform(0.1, 2, 2) * rng.choice([-1, 1], 2) - 0.0
            high = low + rng.choice([0.0, 1e-8, 0.05], 2)
            bounds = arithmetic()(name, low, high)
            for at in itertools.product((0, 0.5, 1), repeat=2):
                x, y = (Fraction(v) for v in low + np.array(at) * (high - low))
                assert bounds[0] <= ARITHMETIC[name][1](x, y) <= bounds[1]


# Elementary functions

FUNCTIONS = {
    "exp": (jnp.exp, mpmath.exp, (-50, 50)),
    "expm1": (jnp.expm1, mpmath.expm1, (-3, 3)),
    "exp2": (jnp.exp2, lambda x: mpmath.mpf(2) ** x, (-20, 20)),
    "log": (jnp.log, mpmath.log, (1e-6, 100)),
    "log1p": (jnp.log1p, mpmath.log1p, (-0.999, 9)),
    "sin": (jnp.sin, mpmath.sin, (-60, 60)),
    "cos": (jnp.cos, mpmath.cos, (-60, 60)),
    "tan": (jnp.tan, mpmath.tan, (-1.5, 1.5)),
    "atan": (jnp.arctan, mpmath.atan, (-40, 40)),
    "asin": (jnp.arcsin, mpmath.asin, (-1, 1)),
    "acos": (jnp.arccos, mpmath.acos, (-1, 1)),
    "sinh": (jnp.sinh, mpmath.sinh, (-4, 4)),
    "cosh": (jnp.cosh, mpmath.cosh, (-4, 4)),
    "tanh": (jnp.tanh, mpmath.tanh, (-5, 5)),
    "sqrt": (jnp.sqrt, mpmath.sqrt, (0, 9)),
    "rsqrt": (lambda x: 1 / jnp.sqrt(x), lambda x: 1 / mpmath.sqrt(x), (0.01, 9)),
    "abs": (jnp.abs, abs, (-2, 2)),
    "floor": (jnp.floor, mpmath.floor, (-9, 9)),
    "ceil": (jnp.ceil, mpmath.ceil, (-9, 9)),
    "power": (lambda x: jnp.power(x, 2.3), lambda x: x ** mpmath.mpf(2.3), (0.1, 9)),
    "power at zero": (lambda x: jnp.power(x, 2.3), lambda x: x ** mpmath.mpf(2.3), (0, 2)),
    "root at zero": (lambda x: jnp.power(x, 0.4), lambda x: x ** mpmath.mpf(0.4), (0, 2)),
    "tiny exponential": (jnp.exp, mpmath.exp, (-2000, -600)),
    "angle": (lambda x: jnp.arctan2(x - 1, x), lambda x: mpmath.atan2(x - 1, x), (0.1, 9)),
}


@functools.cache
def functions() -> Kernels:
    return kernels_of({name: call for name, (call, *_) in FUNCTIONS.items()}, 1)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_functions_are_enclosed_and_tightly_at_points(name):
    _, exact, (low, high) = FUNCTIONS[name]
    rng = np.random.default_rng(5)
    with mpmath.workdps(40):
        for k in range(150):
            x = rng.uniform(low, high) if k else float(low)
            y = min(x + rng.choice([0.0, 1e-9, 0.01, 0.5]), high)
            bounds = functions()(name, x, y)
            for at in (x, y, rng.uniform(x, y)):
                assert bounds[0] <= exact(mpmath.mpf(float(at))) <= bounds[1]
            if x == y:
                # The sine of a large number near a multiple of π is bounded to 1e-14 at least.
                value = abs(float(exact(mpmath.mpf(x))))
                assert bounds[1] - bounds[0] <= 1e-13 * value + 2e-14


# What is undefined


@functools.cache
def faulty() -> Kernels:
    skipped = ("not a number", "divisor a constant 0", "quotient of constants")
    calls = {}
    for (fault, call), hidden in itertools.product(FAULTS.items(), ("as it is", "cut to a range")):
        # Constants are folded when the code is printed; a program with such is never compiled.
        if not (fault in skipped or "constant" in fault or "fold" in fault):
            hide = HIDDEN[hidden]
            calls[f"{fault}, {hidden}"] = lambda x, y, c=call, h=hide: h(c(x, y), x, y)
    return kernels_of(calls, 2)


def test_a_box_with_a_fault_has_no_bounds():
    kernels = faulty()
    assert len(kernels.places) > 30
    for name in kernels.places:
        assert not np.isfinite(kernels(name, *BOX.T)[:2]).any(), name


def test_a_lane_without_bounds_does_not_spoil_its_neighbours():
    """Eight boxes are examined together; only those at the pole cannot be proven."""
    kernel = kernel_of(lambda x: jnp.minimum(1 / x, 3.0))
    found = bound_largest(kernel, np.array([[0.0, 1.0]]), 1.1, threads=1)
    assert found.upper is None and found.at[0] < 1e-300
    found = bound_largest(kernel, np.array([[1e-3, 1.0]]), 1.1, threads=1)
    assert 3 <= found.upper <= 3.3


@functools.cache
def sound() -> Kernels:
    names = [name for name in SOUND if "infinite" not in name]
    return kernels_of({name: SOUND[name] for name in names if "zero" not in name}, 2)


def test_sound_expressions_have_bounds_on_small_boxes():
    rng = np.random.default_rng(6)
    for name in sound().places:
        for _ in range(20):
            low = rng.uniform(*BOX.T) * 0.99
            bounds = sound()(name, low, low + 1e-4)
            middle = float(SOUND[name](*(low + 0.5e-4)))
            # Steps jump, and powers of zero are left out by the logarithm.
            assert bounds[0] - 1e-9 <= middle <= bounds[1] + 1e-9, name


def test_a_radicand_that_is_zero_at_the_boundary_needs_a_proof():
    box = np.array([[0.0, 1.0]])

    def call(x):
        return jnp.sqrt(1 - x * x * x)

    refused = bound_largest(kernel_of(call), box, 1.01)
    assert refused.upper is None or refused.upper <= 1.01
    found = bound_largest(kernel_of(call, roots_are_defined=True), box, 1.01)
    assert 1 <= found.upper <= 1.01


# Conditions


def test_both_cases_of_an_undecided_condition_count():
    kernel = kernel_of(lambda x: jnp.where(x < 0.3, x, 5 - x))
    low, high, *_ = kernel.enclose(np.array([[0.2, 0.4]]))
    assert low <= 0.2 and high >= 4.7
    assert high <= 4.9
    assert kernel.enclose(np.array([[0.2, 0.29]]))[1] <= 0.2900001
    found = bound_largest(kernel, UNIT, 1.01)
    assert 4.69 <= found.lower <= 4.7 <= found.upper <= 4.75


def test_cases_that_belong_together_are_not_mixed():
    """Where x < ½ both selections take their first case: the sum is never 2."""
    kernel = kernel_of(lambda x: jnp.where(x < 0.5, 1.0, x - x) + jnp.where(x < 0.5, x - x, 1.0))
    assert kernel.enclose(np.array([[0.4, 0.6]]))[1] <= 1 + 1e-12


def test_each_combination_of_open_conditions_counts():
    """The second condition is decided. If the first and the third agree, the sum is 0."""

    def steps(x):
        total = jnp.where(x < 0.5, 0.0, 1.0)
        total += jnp.where(x < 0.25, 9.0, 0.0)
        return total - jnp.where(x < 0.51, 0.0, 1.0)

    kernel = kernel_of(steps)
    for low, high, *centre in (kernel.enclose(np.array([[0.45, each]])) for each in (0.54, 0.57)):
        assert low == -1 and high == 1
        assert centre[0] <= 0 and centre[1] >= 1


def test_more_conditions_than_can_be_combined_give_no_bounds():
    def many(x):
        return sum(jnp.where(x < 0.5 + k * 1e-6, x, 1 - x) for k in range(12))

    kernel = kernel_of(many)
    assert not np.isfinite(kernel.enclose(np.array([[0.4, 0.6]]))[0])
    assert np.isfinite(kernel.enclose(np.array([[0.1, 0.2]]))[0])
