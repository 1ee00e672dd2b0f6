"""Bounds of rounding errors: they hold, they are not far above, and they fail where they must."""

import functools
import itertools
from dataclasses import replace

import jax.numpy as jnp
import numpy as np
import pytest

from programs.bounding.adjoints import used_separately
from programs.bounding.compiled import compile_kernel, compiler_missing
from programs.bounding.largest import LargestValue, bound_largest
from programs.bounding.rounding import chained, rounding_parts
from programs.bounding.rounding_model import (
    IEEE,
    MODELS,
    VULKAN,
    OperationError,
    RoundingModel,
)
from programs.functions import Function, Parameter
from programs.program import Program, Step, evaluate, interpret
from programs.tracing.tracer import trace
from tests.programs.kernels import Kernels, rounding_kernels_of

needs_compiler = pytest.mark.skipif(compiler_missing() is not None, reason="no C compiler")
NAMES = "xyz"


def program_of(call, sides: int, name: str = "toy") -> Program:
    parameters = tuple(Parameter(each, (-1.0, 1.0)) for each in NAMES[:sides])
    return trace(Function(name, "", parameters, None, "value", call))


def bound(call, box, model: RoundingModel = IEEE, ratio: float = 1.2) -> LargestValue:
    sides = len(box)
    given = " ".join(f"v[{k}] = x[{k}];" for k in range(sides))
    parts = rounding_parts(program_of(call, sides), model, given, [False] * sides)
    return bound_largest(
        compile_kernel(parts, sides), np.array(box, float), ratio, threads=1, max_boxes=50_000
    )


def measured(call, box, count: int = 200_000) -> float:
    """Return the largest difference of float32 from float64 at random float32 arguments."""
    program, rng = program_of(call, len(box)), np.random.default_rng(0)
    low, high = np.array(box, float).T
    points = rng.uniform(low, high, (count, len(box))).astype(np.float32).astype(float)
    single = evaluate(program, points, np.float32).astype(float)
    return float(np.abs(single - evaluate(program, points)).max())


# Errors at a point, in units of 2^-24, by hand. With a = √x, all of a's error may cancel.
CANCELLED = {
    "larger": (lambda x, y: cancelled(jnp.maximum, x, y), lambda a, y: y if a < y else 0),
    "larger, reversed": (
        lambda x, y: cancelled(lambda a, b: jnp.maximum(b, a), x, y),
        lambda a, y: y if a < y else 0,
    ),
    "smaller": (lambda x, y: cancelled(jnp.minimum, x, y), lambda a, y: 2 * a - y if a > y else 0),
    "smaller, reversed": (
        lambda x, y: cancelled(lambda a, b: jnp.minimum(b, a), x, y),
        lambda a, y: 2 * a - y if a > y else 0,
    ),
    "larger, negative": (
        lambda x, y: jnp.maximum(-jnp.sqrt(x), -y) + jnp.sqrt(x),
        lambda a, y: 2 * a - y if a > y else 0,
    ),
    "smaller, negative": (
        lambda x, y: jnp.minimum(-jnp.sqrt(x), -y) + jnp.sqrt(x),
        lambda a, y: y if a < y else 0,
    ),
    # Here they add up.
    "larger, twice": (
        lambda x, y: jnp.maximum(jnp.sqrt(x), y) + jnp.sqrt(x),
        lambda a, y: 4 * a if a > y else 2 * a + y,
    ),
    "smaller, twice": (
        lambda x, y: jnp.minimum(jnp.sqrt(x), y) + jnp.sqrt(x),
        lambda a, y: 4 * a if a < y else 2 * a + y,
    ),
    "size": (
        lambda x, y: cancelled(lambda d, _: jnp.abs(d), x, y, jnp.subtract),
        lambda a, y: 4 * (y - a) + 2 * a if a < y else 0,
    ),
    "negative size": (
        lambda x, y: cancelled(lambda d, _: -jnp.abs(d), x, y, jnp.subtract),
        lambda a, y: 4 * (a - y) + 2 * a if a > y else 0,
    ),
    "constant": (
        lambda x, y: (0.1 + y) - jnp.sqrt(x) * 0.5,
        lambda a, y: 0.025 + abs(0.1 + y) + a / 2 + abs(0.1 + y - a / 2),
    ),
    "negative constant": (
        lambda x, y: (y - 0.7) - jnp.sqrt(x) * 0.5,
        lambda a, y: 0.2 + abs(y - 0.7) + a / 2 + abs(y - 0.7 - a / 2),
    ),
    # Both cases have one value, and one has no error.
    "cases": (
        lambda x, y: jnp.where(y < 1.5, x, (x + 100) - 100),
        lambda a, y: 0 if y < 1.5 else 100 + 2 * a * a,
    ),
    "cases, reversed": (
        lambda x, y: jnp.where(y < 1.5, (x + 100) - 100, x),
        lambda a, y: 100 + 2 * a * a if y < 1.5 else 0,
    ),
}


def cancelled(call, x, y, first=lambda a, _: a):
    value = first(jnp.sqrt(x), y)
    return call(value, y) - value


@functools.cache
def cancelling() -> Kernels:
    programs = {name: program_of(call, 2) for name, (call, _) in CANCELLED.items()}
    return rounding_kernels_of(programs, IEEE, 2)


@needs_compiler
@pytest.mark.parametrize("name", CANCELLED)
def test_bounds_at_points_are_tight_and_those_on_boxes_hold_at_their_points(name):
    _, exact = CANCELLED[name]
    bound = functools.partial(cancelling(), name)
    for x, y in itertools.product((1.0, 2.25, 4.0), (1.2, 1.4, 1.7, 1.9)):
        _, upper, _, at_centre = bound([x, y], [x, y])
        expected = exact(x**0.5, y) * 2.0**-24
        assert expected <= upper <= expected * (1 + 1e-5) + 1e-13
        assert expected <= at_centre <= expected * (1 + 1e-5) + 1e-13
    # The cases change on these boxes: to either side of the centre, by x and by y.
    for low, high in (
        ([1, 1.4], [4, 1.4]),
        ([1, 1.7], [4, 1.7]),
        ([2.25, 1.0], [2.25, 1.9]),
        ([2.25, 1.1], [2.25, 2.1]),
        ([1, 1.0], [4, 1.9]),
        ([1, 1.1], [4, 2.0]),
        ([1.9, 1.42], [2.2, 1.42]),
        ([1.9, 1.44], [2.2, 1.44]),
        ([2.0, 1.38], [2.0, 1.46]),
        ([2.0, 1.36], [2.0, 1.44]),
    ):
        _, upper, *at_centre = bound(low, high)
        x, y = np.mean([low, high], axis=0)
        assert at_centre[0] <= exact(x**0.5, y) * 2.0**-24 <= at_centre[1]
        places = itertools.product(*np.linspace(low, high, 5).T)
        assert upper >= max(exact(x**0.5, y) for x, y in places) * 2.0**-24


# What is bounded. The last number: the largest quotient of the bound and of what is measured.
CALLS = {
    "quotient and root": (
        lambda x, y: jnp.sqrt(1.1 + x * y) / (1.3 + x * (0.7 + y)),
        [(0, 1), (0, 1)],
        5,
    ),
    "functions": (
        lambda x, y: jnp.exp(-x) * jnp.cos(y) + jnp.log(1 + x) * jnp.maximum(x, y),
        [(0, 1), (0, 1)],
        6,
    ),
    # The two cases meet smoothly at x² = ½, where rounding may exchange them.
    "smooth selection": (
        lambda x, y: jnp.where(x * x < 0.5, 0.0, (x * x - 0.5) * (x * x - 0.5)) / (1.5 + y) + x,
        [(0, 1), (0, 1)],
        6,
    ),
}


@needs_compiler
@pytest.mark.parametrize("name", CALLS)
def test_bounds_hold_and_are_not_vacuous(name):
    call, box, most = CALLS[name]
    found, largest = bound(call, box), measured(call, box)
    assert largest <= found.upper <= most * largest
    assert found.upper <= 1.2001 * found.lower


@needs_compiler
def test_rounding_may_change_an_outcome_where_the_exact_one_is_certain():
    """The sum with y has an error of 3e-5, so that either case is taken that far from x = ½.

    A search divides there: then x² is below ¼ on the boxes on one side, and the case is certain.
    """

    def steep(x, y):
        return jnp.where((x * x + y) - y < 0.25, 0.0, (x - 0.5) * 8.0)

    found = bound(steep, [(0.25, 0.75), (1000, 1001)])
    largest = measured(steep, [(0.4999, 0.5001), (1000, 1001)])
    assert largest > 2e-4
    assert found.upper is None or largest <= found.upper <= 4 * largest


@needs_compiler
def test_values_near_the_largest_float32_are_not_bounded():
    """Above 0.99 of it, rounding might give infinity. A part of a box that is above is enough."""
    parts = rounding_parts(program_of(lambda x: -3.0 * x, 1), IEEE, "v[0] = x[0];", [False])
    kernel = compile_kernel(parts, 1)
    largest = float(np.finfo(np.float32).max)
    for part, holds in ((0.985, True), (0.995, False), (1.005, False)):
        for low, high in ((0.1, part), (-part, -0.1), (part, part), (-part, -part)):
            found = kernel.enclose(np.array([[low, high]]) * largest / 3)
            assert np.isfinite(found[:2]).all() == holds


CONDITIONS = {
    "lt": lambda y, c: y < c, "le": lambda y, c: y <= c, "gt": lambda y, c: y > c,
    "ge": lambda y, c: y >= c, "eq": lambda y, c: y == c, "ne": lambda y, c: y != c,
}  # fmt: skip


@functools.cache
def conditional() -> Kernels:
    def call(holds):
        return lambda x, y: jnp.where(holds(y, 1.5), x, (x + 100) - 100)

    programs = {name: program_of(call(holds), 2) for name, holds in CONDITIONS.items()}
    return rounding_kernels_of(programs, IEEE, 2)


@needs_compiler
@pytest.mark.parametrize("name", CONDITIONS)
def test_a_condition_selects_the_case_whose_error_counts(name):
    for x, y in itertools.product((1.0, 3.0), (1.25, 1.5, 1.75)):
        _, upper, *_ = conditional()(name, [x, y], [x, y])
        expected = 0 if CONDITIONS[name](y, 1.5) else (100 + 2 * x) * 2.0**-24
        assert expected <= upper <= expected * (1 + 1e-5) + 1e-30


# The error of one operation at x = 3 in units of 2^-23, in each model
OPERATIONS = {
    "sum": (lambda x: x + 8.0, 11 / 2, 11),
    "twice": (lambda x: x + x, 0, 0),
    "product": (lambda x: x * 5.0, 15 / 2, 15),
    "product with a power of two": (lambda x: 0.125 * x, 0, 0),
    "product with a negative power of two": (lambda x: x * -4.0, 0, 0),
    "square": (lambda x: x * x, 9 / 2, 9),
    "quotient": (lambda x: x / 5.0, 0.6 / 2, 0.6 * 2.5),
    # Traced programs have a product in place of the first one.
    "quotient by a power of two": (Step("div", (0, 4.0)), 0, 0.75 * 2.5),
    "quotient of a power of two": (Step("div", (4.0, 0)), 4 / 6, 4 / 3 * 2.5),
    "exponential": (jnp.exp, np.exp(3), np.exp(3) * (3 + 2 * 3)),
    "of a negative number": (lambda x: jnp.exp(-x), np.exp(-3), np.exp(-3) * (3 + 2 * 3)),
    "logarithm": (jnp.log, np.log(3), np.log(3) * 3 + 4),
    "cosine": (jnp.cos, -np.cos(3), 4096),
}


@functools.cache
def operations(model: str) -> Kernels:
    programs = {
        name: Program(name, ("x",), (call,), (1,))
        if isinstance(call, Step)
        else program_of(call, 1)
        for name, (call, *_) in OPERATIONS.items()
    }
    return rounding_kernels_of(programs, MODELS[model], 1)


@needs_compiler
@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("name", OPERATIONS)
def test_the_error_of_one_operation_is_that_of_the_model(name, model):
    expected = dict(zip(MODELS, OPERATIONS[name][1:], strict=True))[model] * 2.0**-23
    _, upper, *_ = operations(model)(name, 3.0, 3.0)
    assert expected * (1 - 1e-9) <= upper <= expected * (1 + 1e-5) + 2.0**-125


@needs_compiler
def test_arguments_are_rounded_before_they_are_given_to_the_program():
    """The float32 number for ½ (1 + d) is ½ if |d| < 2^-24, where 1/(x − ½) has no bound."""
    kernels = []
    for rounded in (False, True):
        program = program_of(lambda x, y: 1 / (x - 0.5) + y, 2)
        parts = rounding_parts(program, IEEE, "v[0] = x[0]; v[1] = x[1];", [rounded, False])
        kernels.append(compile_kernel(parts, 2))
    for part, holds in ((0.99, [True, False]), (1.01, [True, True])):
        for sign in (-1, 1):
            point = np.array([[0.5 * (1 + sign * part * 2.0**-24)] * 2, [1.0, 1.0]])
            assert [bool(np.isfinite(k.enclose(point)[1])) for k in kernels] == holds
    # Where a number is too small for a normal one, its sign is lost.
    parts = rounding_parts(program_of(lambda x: 1 / x, 1), IEEE, "v[0] = x[0];", [True])
    kernel = compile_kernel(parts, 1)
    for x, holds in ((0.9 * 2.0**-126, False), (1.5 * 2.0**-126, True)):
        assert np.isfinite(kernel.enclose(np.array([[x, x]]))[1]) == holds


def test_more_conditions_than_can_be_numbered_are_refused():
    def steps(count):
        return lambda x: sum(jnp.where(x < k + 0.5, 1.0, x) for k in range(count))

    _, check, *_ = rounding_parts(program_of(steps(64), 1), IEEE, "", [False])
    assert "__COUNTER__ <= 0," in check
    with pytest.raises(ValueError, match="65 conditions; allowed: at most 64"):
        rounding_parts(program_of(steps(65), 1), IEEE, "", [False])


def test_errors_are_those_that_the_standards_state():
    """Vulkan's table of core instructions, and what glibc's manual states; in ULP."""
    ieee, vulkan = ({k: e for k, e in m.errors.items() if not e.none} for m in MODELS.values())
    glibc = ["exp", "exp2", "expm1", "log", "log1p", "pow", "sin", "cos", "tan"]
    glibc += ["asin", "acos", "atan", "atan2"]
    assert ieee == {
        **dict.fromkeys(["add", "sub", "mul", "div", "sqrt"], OperationError(0.5)),
        **dict.fromkeys(["rsqrt", *glibc], OperationError(1.0)),
        **dict.fromkeys(["sinh", "cosh", "tanh"], OperationError(2.0)),
    }
    root = vulkan.pop("sqrt").ulps
    # A quotient by an inverse root: (1 + 2.5 u) (1 + 2 u) at least
    assert 4.5 < root < 5
    assert vulkan == {
        **dict.fromkeys(["add", "sub", "mul"], OperationError(1.0)),
        "div": OperationError(2.5),
        "rsqrt": OperationError(2.0),
        **dict.fromkeys(["exp", "exp2"], OperationError(3.0, 2.0)),
        "log": OperationError(3.0, 0.0, 2.0**-21),
        **dict.fromkeys(["sin", "cos"], OperationError(0.0, 0.0, 2.0**-11)),
    }


@needs_compiler
def test_an_absolute_error_is_in_all_that_follows():
    """The cosine of Vulkan is wrong by a = 2^-11, so that its square is by a² where it is zero."""
    square = program_of(lambda x: jnp.square(jnp.cos(x)), 1)
    kernel = rounding_kernels_of({"square": square}, VULKAN, 1)
    for low, high in ((np.pi / 2, np.pi / 2), (1.5, 1.6)):
        _, upper, _, at_centre = kernel("square", low, high)
        assert min(upper, at_centre) >= 2.0**-22
    _, upper, *_ = kernel("square", np.pi / 2, np.pi / 2)
    # The derivative on the whole of what the error allows is bounded, which gives twice as much.
    assert upper <= 2.01 * 2.0**-22


@needs_compiler
def test_an_error_that_grows_with_the_argument_is_that_of_the_largest_on_a_box():
    """Here exp(x) may be wrong by (⅛ + ⅞ |x|) times itself: at 1 it doubles, its power more."""
    part = 2.0**23 / 8

    def power(x):
        x = jnp.exp(x)
        for _ in range(5):
            x = x * x
        return x

    errors = {**IEEE.errors, "exp": OperationError(part, 7 * part), "mul": OperationError()}
    kernel = rounding_kernels_of({"power": program_of(power, 1)}, replace(IEEE, errors=errors), 1)
    for low, high, x in ((0.0, 1.0, 1.0), (-1.0, 0.0, -1.0), (1.0, 1.0, 1.0)):
        _, upper, *_ = kernel("power", low, high)
        assert np.exp(32 * x) * (2.0**32 - 1) <= upper
    # The derivative is bounded by its value for the largest errors.
    assert upper <= np.exp(32) * 32 * 2.0**31 * (1 + 1e-6)


@needs_compiler
@pytest.mark.parametrize(("count", "bounded"), [(4, True), (5, False)])
def test_four_outcomes_that_rounding_may_change_are_combined(count, bounded):
    """At x = ½ no condition is certain. If all of the cases are taken, the value is larger by n."""

    def steps(x):
        return sum((jnp.where((x + k) - k < 0.5, 0.0, 1.0) for k in range(1, count + 1)), start=x)

    kernel = rounding_kernels_of({"steps": program_of(steps, 1)}, IEEE, 1)
    low, upper, *_ = kernel("steps", 0.5, 0.5)
    assert np.isfinite([low, upper]).all() == bounded
    if bounded:
        assert count <= upper <= count + 1e-6


@needs_compiler
def test_the_largest_jump_on_a_box_counts():
    """The cases of a condition that is uncertain at y = 1.5 meet at the centre of the box only."""
    jump = program_of(lambda x, y: jnp.where((y + 1) - 1 < 1.5, x, 3 - x), 2)
    kernel = rounding_kernels_of({"jump": jump}, IEEE, 2)
    _, upper, *_ = kernel("jump", [1.0, 1.5], [2.0, 1.5])
    assert 1 <= upper <= 1 + 1e-6


@needs_compiler
def test_outcomes_are_compared_without_their_rounding():
    """Both cases have the value of the first step, so that no outcome changes it."""

    def same(x, y):
        total = x + 100
        return jnp.where(y < 1.5, total, jnp.maximum(total, 1))

    kernel = rounding_kernels_of({"same": program_of(same, 2)}, IEEE, 2)
    _, upper, *_ = kernel("same", [1.0, 1.4], [1.0, 1.6])
    assert 101 * 2.0**-24 <= upper <= 101 * 2.0**-24 * (1 + 1e-5)


@needs_compiler
def test_each_combination_of_uncertain_outcomes_counts():
    """The second condition is certain at x = ½. If the first and the third agree, the sum is 0."""

    def steps(x):
        total = jnp.where((x + 1) - 1 < 0.5, 0.0, 1.0)
        total += jnp.where(x < 0.25, 9.0, 0.0)
        return total - jnp.where((x + 2) - 2 < 0.5, 0.0, 1.0)

    kernel = rounding_kernels_of({"steps": program_of(steps, 1)}, IEEE, 1)
    _, upper, *_ = kernel("steps", 0.5, 0.5)
    # It is the largest difference of any two outcomes.
    assert 1 <= upper <= 2 + 1e-6


@needs_compiler
def test_results_that_are_too_small_may_become_zero():
    """Each product is exact but for underflow: 2^-63 · 2^-64 is half the least normal number."""
    small = program_of(lambda x: (x * 2.0**-64) * 2.0**20, 1)
    kernel = rounding_kernels_of({"small": small}, IEEE, 1)
    _, upper, _, at_centre = kernel("small", 2.0**-63, 2.0**-63)
    for each in (upper, at_centre):
        assert 2.0**-107 <= each <= 2.0**-105


@needs_compiler
def test_the_bound_on_a_box_is_above_those_at_its_points():
    parts = rounding_parts(program_of(lambda x: x * x * x + x, 1), IEEE, "v[0] = x[0];", [False])
    kernel = compile_kernel(parts, 1)
    _, upper, *_ = kernel.enclose(np.array([[0.1, 2.0]]))
    assert upper >= max(kernel.enclose(np.array([[x, x]]))[1] for x in (0.1, 0.7, 1.9, 2.0))


@needs_compiler
def test_conditions_of_the_arguments_are_independent_of_those_of_the_program():
    """The first input is |x − ½|, by a condition; the program has a condition of its own."""
    program = program_of(lambda d, y: jnp.where(y < 0.5, d - 0.25, 0.25 - d) * (y - 0.5), 2)
    choice = "SELECT(LT(x[0], 0.5), SUB(0.5, x[0]), SUB(x[0], 0.5))"
    parts = rounding_parts(program, IEEE, f"v[0] = {choice}; v[1] = x[1];", [False] * 2)
    kernel = compile_kernel(parts, 2)
    # Each combination of outcomes is on a part of this box, and none is on all of it.
    _, upper, *_ = kernel.enclose(np.array([[0.25, 0.75], [0.25, 0.75]]))
    corners = [
        kernel.enclose(np.array([[x] * 2, [y] * 2])) for x in (0.25, 0.75) for y in (0.3, 0.7)
    ]
    assert upper >= max(high for _, high, *_ in corners) > 0
    assert all("decide(K, 63," in part for part in parts[2:4])


@needs_compiler
def test_cancellation_makes_a_bound_large():
    """The sum with 1000 loses ten bits; without it, the bound is that of a few roundings."""

    def cancels(x):
        return (x * 3.0 + 1000.0) - 1000.0

    found, plain = bound(cancels, [(0, 1)]), bound(lambda x: x * 3.0, [(0, 1)])
    assert measured(cancels, [(0, 1)]) <= found.upper
    assert 2e-5 < found.upper < 2e-4
    assert plain.upper < 4e-7


@needs_compiler
def test_a_model_that_promises_too_much_is_contradicted_by_measurement():
    call, box, _ = CALLS["quotient and root"]
    wrong = replace(
        IEEE,
        errors={
            name: OperationError(each.ulps / 10) if each.ulps else each
            for name, each in IEEE.errors.items()
        },
    )
    assert bound(call, box, wrong).upper < measured(call, box)


@needs_compiler
def test_terms_of_higher_order_are_in_the_bound():
    """With errors of 5 %, x¹⁶ by squares may be wrong by 1.05¹⁵ − 1; the first order is 0.75."""
    part = 0.05
    coarse = replace(IEEE, errors={**IEEE.errors, "mul": OperationError(part * 2.0**23)})

    def power(x):
        for _ in range(4):
            x = x * x
        return x

    # The search compares the bound with the sum for the smallest values that rounding may give.
    found = bound(power, [(0.99, 1.0)], coarse, ratio=8.0)
    largest = interpret(
        program_of(power, 1), [1.0], {"mul": lambda a, b: a * b * (1 + part)}, float
    )[0]
    assert largest - 1 == pytest.approx(1.05**15 - 1) and largest - 1 > 15 * part
    assert largest - 1 <= found.upper <= 2 * (largest - 1)


@needs_compiler
def test_the_size_of_a_product_may_be_fused_with_a_sum_too():
    """|x·y| + c is rounded once, and max(x·y, 0) too; otherwise the roundings of x·y cancel."""
    c = float(np.float32(0.03))
    found = bound(lambda x, y: (jnp.abs(x * y) + c) - jnp.maximum(x * y, 0.0), [(0.99, 1)] * 2)
    x, y = np.random.default_rng(2).uniform(0.99, 1, (2, 100_000)).astype(np.float32).astype(float)
    total, product = (x * y + c).astype(np.float32), (x * y).astype(np.float32)
    error = np.abs((total - product).astype(float) - c).max()
    assert error > 1.4 * 2.0**-24
    assert error <= found.upper <= 2.2 * error


def test_products_whose_uses_are_rounded_apart_are_found():
    """Numbers of steps: 2 is the product."""
    cases: dict[tuple, set[int]] = {
        (("mul", 0, 1), ("add", 2, 0)): set(),
        (("mul", 0, 1), ("add", 2, 2)): {2},
        (("mul", 0, 1), ("add", 2, 0), ("exp", 2)): {2},
        (("mul", 0, 1), ("sub", 0, 2), ("mul", 2, 3)): {2},
        (("mul", 0, 1), ("exp", 2), ("div", 2, 3)): set(),
        (("mul", 0, 1), ("exp", 2), ("add", 3, 2.0)): set(),
        (("div", 0, 1), ("add", 2, 0), ("exp", 2)): set(),
        # By its negative or its size, and by the negative of its size
        (("mul", 0, 1), ("neg", 2), ("add", 3, 0), ("exp", 2)): {2, 3},
        (("mul", 0, 1), ("abs", 2), ("sub", 3, 0), ("exp", 3)): {2, 3},
        (("mul", 0, 1), ("abs", 2), ("neg", 3), ("add", 4, 0), ("max", 2, 0.5)): {2, 3, 4},
        (("mul", 0, 1), ("abs", 2), ("add", 3, 0)): set(),
        (("mul", 0, 1), ("neg", 2), ("exp", 3), ("exp", 2)): set(),
    }
    for steps, expected in cases.items():
        listed = tuple(Step(operation, tuple(operands)) for operation, *operands in steps)
        program = Program("Example", ("x", "y"), listed, (len(steps) + 1,))
        assert used_separately(program) == expected, steps
    # An output is a use.
    steps = (Step("mul", (0, 1)), Step("add", (2, 0)))
    assert used_separately(Program("Example", ("x", "y"), steps, (2, 3))) == {2}


@needs_compiler
def test_what_vulkan_allows_is_more_than_rounding_to_nearest():
    call, box, _ = CALLS["quotient and root"]
    assert 3 * bound(call, box).upper < bound(call, box, VULKAN).upper

    def cosine(x):
        return 2 * jnp.cos(x)

    assert 2.0**-10 < bound(cosine, [(0, 1)], VULKAN).upper < 2.01 * 2.0**-11


@needs_compiler
@pytest.mark.parametrize(
    "call",
    [
        pytest.param(lambda x: jnp.where(x * x < 0.3, x, 5 - x), id="jump"),
        pytest.param(lambda x: 1 / (x - 0.3), id="pole"),
        pytest.param(lambda x: 1 / (x * 1e38 * 100.0 + 1e30), id="overflow"),
    ],
)
def test_what_cannot_be_bounded_is_not_proven(call):
    """Rounding may cross a jump, a quotient may have no bound, and float32 may overflow."""
    assert bound(call, [(0, 1)]).upper is None


def test_an_operation_without_a_known_error_is_refused():
    for call, model in ((jnp.floor, IEEE), (jnp.tan, VULKAN)):
        with pytest.raises(ValueError, match="has no known bound in the model"):
            rounding_parts(program_of(call, 1), model, "", [False])


def test_chained_programs_compute_one_after_the_other():
    first = trace(
        Function(
            "first", "", (Parameter("x", (0.0, 1.0)),), 2, "m", lambda x: (x * x + 0.5, jnp.exp(x))
        )
    )
    second = trace(
        Function(
            "second",
            "",
            (Parameter("m", (0.0, 9.0), size=2), Parameter("y", (0.0, 1.0))),
            None,
            "value",
            lambda m, y: m[0] * y / (m[1] + y * y),
        )
    )
    both, points = chained([first, second]), np.random.default_rng(1).random((50, 2))
    between = evaluate(first, points[:, :1])
    apart = evaluate(second, np.concatenate([between, points[:, 1:]], axis=1))
    assert both.inputs == ("x", "y")
    np.testing.assert_array_equal(evaluate(both, points), apart)
