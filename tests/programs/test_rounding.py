"""Bounds of rounding errors: they hold, they are not far above, and they fail where they must."""

from dataclasses import replace

import jax.numpy as jnp
import numpy as np
import pytest

from programs.bounding.adjoints import used_separately
from programs.bounding.compiled import compile_kernel, compiler_missing
from programs.bounding.largest import LargestValue, bound_largest
from programs.bounding.rounding import chained, rounding_parts
from programs.bounding.rounding_model import IEEE, VULKAN, OperationError, RoundingModel
from programs.functions import Function, Parameter
from programs.program import Program, Step, evaluate, interpret
from programs.tracing.tracer import trace

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
