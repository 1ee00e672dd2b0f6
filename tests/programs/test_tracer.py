"""Tracing: which programs JAX functions become, which names they keep, and what is refused."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from jax import lax
from jax.scipy.special import erf

from programs.functions import Function, Parameter, group_inputs
from programs.program import Step, evaluate
from programs.tracing.tracer import trace


def of_scalars(call, names: str = "x", result=None) -> Function:
    """Make a function of scalars with these names from a JAX callable."""
    parameters = tuple(Parameter(name, (-1.0, 1.0)) for name in names.split())
    return Function("Example", "An example.", parameters, result, "results", call)


def operations(program):
    return [step.operation for step in program.steps]


def in_jax(function, rows):
    batched = jax.jit(jax.vmap(lambda *row: function.call(*group_inputs(function, row))))
    return np.stack(jax.tree.leaves(batched(*rows.T)), axis=1)


@jax.custom_jvp
def _with_own_derivative(x):
    return x * 3.0


_with_own_derivative.defjvps(lambda tangent, answer, x: 3.0 * tangent)


@jax.custom_vjp
def _with_own_pullback(x):
    return x * 3.0


_with_own_pullback.defvjp(lambda x: (x * 3.0, None), lambda residual, g: (3.0 * g,))

TABLE = np.array([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]])
INDICES = np.array([0, 2])

# What an author may write, and the number of operations of its program
IDIOMS = {
    "jit": (jax.jit(lambda t: t * 3.0), 1),
    "custom_jvp": (_with_own_derivative, 1),
    "custom_vjp": (_with_own_pullback, 1),
    "checkpoint": (jax.checkpoint(lambda t: t * 3.0), 1),
    "square": (jnp.square, 1),
    "fifth power": (lambda x: x**5, 3),
    "reciprocal power": (lambda x: x**-2, 2),
    "zeroth power": (lambda x: x**0 + x, 1),
    "clip": (lambda x: jnp.clip(x, -0.25, 0.5), 2),
    "clamp": (lambda x: lax.clamp(-0.25, x, 0.5), 2),
    "sign": (jnp.sign, 4),
    "sigmoid": (jax.nn.sigmoid, 4),
    "indexed constant": (lambda x: TABLE[1, 2] * x, 1),
    "indexed device constant": (lambda x: jnp.asarray(TABLE)[1, 2] * x, 1),
    "gathered": (lambda x: jnp.sum(jnp.stack([x, 2.0 * x, 5.0 * x])[INDICES]), 2),
    "dot": (lambda x: TABLE[0] @ jnp.stack([x, x * x, x**3]), 2 + 2 + 2),
    "matrix": (lambda x: jnp.sum(TABLE @ jnp.stack([x, x * x, x**3])), 2 + 5 + 5),
    "set": (lambda x: jnp.sum(jnp.zeros(3).at[1].set(x)), 0),
    "mean": (lambda x: jnp.mean(jnp.stack([x, x * x])), 3),
    "product": (lambda x: jnp.prod(jnp.stack([x, x, x])), 2),
    "largest": (lambda x: jnp.max(jnp.stack([x, -x])), 2),
    "norm": (lambda x: jnp.linalg.norm(jnp.stack([x, 0.5 * x])), 5),
    "cross": (lambda x: jnp.cross(jnp.stack([x, 1.0, x]), jnp.stack([0.5, x, 2.0]))[2], 2),
    "concatenated": (lambda x: jnp.concatenate([jnp.stack([x]), np.ones(2)]).sum(), 2),
    "reversed": (lambda x: jnp.flip(jnp.stack([x, 2.0 * x]))[0], 1),
    "padded": (lambda x: jnp.pad(jnp.stack([x]), (1, 1), constant_values=2.0).sum(), 2),
    "polyval": (lambda x: jnp.polyval(jnp.asarray(TABLE[0]), x), 3),
    "scan": (lambda x: lax.fori_loop(0, 3, lambda i, t: t * x, x), 3),
    "chosen": (lambda x: jnp.where(x > 0.25, x, -x), 3),
    "larger": (lambda x: jnp.where(x < 0.25, 0.25, x), 1),
    "smaller": (lambda x: jnp.where(x >= 0.25, 0.25, x), 1),
    "larger still": (lambda x: jnp.where(x > 0.25, x, 0.25), 1),
    "neither": (lambda x: jnp.where(x > 0.25, x, 0.5), 2),
    "counted": (lambda x: jnp.where(x > 0.25, 1, 0) * 1.0, 2),
    "truth": (lambda x: jnp.float64((x > -0.5) & ~(x > 0.5)), 5),
    "half": (lambda x: lax.rsqrt(x + 2.0), 2),
}


@pytest.mark.parametrize("name", IDIOMS)
def test_idiomatic_jax_code_traces_to_few_operations(name):
    call, count = IDIOMS[name]
    function = of_scalars(call)
    program = trace(function)
    rows = np.linspace(-0.9, 0.95, 12)[:, None]
    np.testing.assert_allclose(evaluate(program, rows), in_jax(function, rows), rtol=1e-14)
    assert len(program.steps) == count, operations(program)


NEUTRAL = {
    "times one": lambda x: x * 1.0,
    "one times": lambda x: 1.0 * x,
    "plus zero": lambda x: x + 0.0,
    "minus zero": lambda x: x - 0.0,
    "over one": lambda x: x / 1.0,
    "twice negated": lambda x: jnp.negative(-x),
    "selected either way": lambda x: jnp.where(x > 0.0, x, x),
    "known condition": lambda x: jnp.where(np.pi > 3.0, x, 2.0 * x),
    "first power": lambda x: x**1,
    "plus zero times": lambda x: x + 0.0 * jnp.sin(x),
}


@pytest.mark.parametrize("name", NEUTRAL)
def test_neutral_operations_are_dropped(name):
    assert trace(of_scalars(NEUTRAL[name])).steps == ()


def test_sums_are_not_reassociated():
    program = trace(of_scalars(lambda x, y: (x - (y - x)) + 1.0, "x y"))
    assert [(s.operation, s.operands) for s in program.steps] == [
        ("sub", (1.0, 0.0)),
        ("sub", (0, 2)),
        ("add", (3, 1.0)),
    ]


def test_equal_products_are_shared_in_either_order():
    program = trace(of_scalars(lambda x, y: jnp.sin(x * y) + jnp.sin(y * x), "x y"))
    assert operations(program) == ["mul", "sin", "add"]


def test_powers_share_their_products():
    program = trace(of_scalars(lambda x: x**2 + x**3 + x**4 + x * x))
    assert operations(program).count("mul") == 3


def test_constants_are_folded_in_float64():
    program = trace(of_scalars(lambda x: x * (jnp.sqrt(2.0) / 3.0)))
    assert program.steps == (Step("mul", (0, np.sqrt(2.0) / 3.0)),)


def test_division_by_a_power_of_two_becomes_a_product():
    program = trace(of_scalars(lambda x: x / 2.0 + x / -0.25 + x / 3.0))
    assert [s.operands for s in program.steps if s.operation == "mul"] == [(0.5, 0), (-4.0, 0)]
    assert operations(program).count("div") == 1


def test_minus_zero_and_zero_are_different_constants():
    program = trace(of_scalars(lambda x: jnp.arctan2(x, 0.0) + jnp.arctan2(x, -0.0)))
    assert operations(program).count("atan2") == 2


def test_values_have_the_names_of_the_author_s_variables():
    def call(alpha):
        beta = 1.0 - alpha
        beta2 = beta * beta
        halves = jnp.stack([beta, alpha]) * 0.5
        clipped = jnp.clip(beta, 0.2, 0.9)
        return beta2 * clipped + jnp.sin(halves[0]) + jnp.cos(halves[1])

    hints = {step.hint: step.operation for step in trace(of_scalars(call, "alpha")).steps}
    assert hints["beta"] == "sub"
    assert hints["beta2"] == "mul"
    assert hints["halves0"] == hints["halves1"] == "mul"
    assert hints["clipped"] == "min"


def _squared(value):
    product = value * value
    return product


@jax.jit
def _compiled(value):
    inner = value * 3.0
    return jnp.sin(inner) + inner


def test_names_are_found_inside_helper_functions():
    def call(alpha):
        bounded = _at_least(alpha)
        square = _squared(bounded)
        compiled = _compiled(square)
        first, second = compiled + 1.0, compiled + 2.0
        return first / second

    # A name inside a helper wins over a name outside, since it is closer to the operation. The name
    # `traced` is not used, although trace(…) itself stands in an assignment.
    traced = trace(of_scalars(call, "alpha"))
    assert [(step.hint, step.operation) for step in traced.steps] == [
        ("bounded", "max"),
        ("product", "mul"),
        ("inner", "mul"),
        (None, "sin"),
        ("compiled", "add"),
        (None, "add"),
        (None, "add"),
        (None, "div"),
    ]


def _at_least(value):
    return jnp.where(value < 0.25, 0.25, value)


REFUSED = {
    "erf": (erf, "'erf' in Example cannot be written as shader code; allowed: .*sqrt"),
    "while": (
        lambda x: lax.while_loop(lambda t: t < 1.0, lambda t: t + 0.1, x),
        "'while' in Example",
    ),
    "sort": (lambda x: jnp.sort(jnp.stack([x, -x]))[0], "'sort' in Example"),
    "float32": (
        lambda x: jnp.float64(jnp.float32(x) * 2),
        "'convert_element_type' in Example: a value of type float32",
    ),
    "whole": (lambda x: jnp.float64(jnp.int64(x)), "in Example: a rounding to whole numbers"),
    "index": (lambda x: jnp.asarray(TABLE[0])[jnp.int64(x)], "in Example: a rounding to whole"),
    "batched product": (
        lambda x: jnp.einsum("bi,bi->b", TABLE * x, TABLE)[0],
        "'dot_general' in Example: a batched product",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_an_operation_that_cannot_be_written_is_named_in_the_error(name):
    call, message = REFUSED[name]
    with pytest.raises(ValueError, match=message):
        trace(of_scalars(call))


def test_an_index_that_depends_on_the_input_is_refused():
    def call(x):
        return lax.dynamic_index_in_dim(TABLE[0] * x, jnp.where(x > 0.0, 1, 0), keepdims=False)

    with pytest.raises(ValueError, match=r"in Example: (an index that depends|a value of type)"):
        trace(of_scalars(call))


def test_float64_must_be_on():
    with jax.enable_x64(False), pytest.raises(ValueError, match="jax_enable_x64 is False"):
        trace(of_scalars(jnp.sin))


@pytest.mark.parametrize(
    ("call", "result", "message"),
    [
        (lambda x: (x, x), None, "allowed: a scalar"),
        (lambda x: x, 2, "allowed: a tuple of 2"),
        (lambda x: (x, x, x), 2, "allowed: a tuple of 2"),
        (lambda x: jnp.stack([x, x]), None, r"shape \(2,\)"),
        (lambda x: x > 0.0, None, "type bool"),
    ],
)
def test_results_must_agree_with_the_declared_result(call, result, message):
    with pytest.raises(ValueError, match=message):
        trace(of_scalars(call, "x", result))


def test_a_program_longer_than_the_limit_is_refused():
    def call(x):
        return lax.fori_loop(0, 1_000_000, lambda i, t: t * x + 0.5, x)

    with pytest.raises(ValueError, match="more than 100 steps"):
        trace(of_scalars(call), limit=100)
