import jax
import jax.numpy as jnp
import numpy as np
import pytest
from jax import lax
from jax.scipy.special import erf

from programs.functions import Function, Parameter, group_inputs, input_names
from programs.program import Program, Step, evaluate, interpret
from programs.tracing.tracer import trace


def of_scalars(call, names: str = "x", result=None) -> Function:
    """Make a function of scalars from a JAX callable, for tests that only look at its program."""
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
GOOD = np.array([0, 2])

# what the author may write -> how many operations it takes
NATURAL = {
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
    "gathered": (lambda x: jnp.sum(jnp.stack([x, 2.0 * x, 5.0 * x])[GOOD]), 2),
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


@pytest.mark.parametrize("name", NATURAL)
def test_natural_code_traces_into_few_operations(name):
    call, count = NATURAL[name]
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
def test_what_changes_nothing_is_no_operation(name):
    assert trace(of_scalars(NEUTRAL[name])).steps == ()


def test_sums_are_not_reassociated():
    program = trace(of_scalars(lambda x, y: (x - (y - x)) + 1.0, "x y"))
    assert [(s.operation, s.operands) for s in program.steps] == [
        ("sub", (1.0, 0.0)),
        ("sub", (0, 2)),
        ("add", (3, 1.0)),
    ]


def test_products_in_either_order_are_one():
    program = trace(of_scalars(lambda x, y: jnp.sin(x * y) + jnp.sin(y * x), "x y"))
    assert operations(program) == ["mul", "sin", "add"]


def test_powers_share_their_products():
    program = trace(of_scalars(lambda x: x**2 + x**3 + x**4 + x * x))
    assert operations(program).count("mul") == 3


def test_constants_are_folded_in_float64():
    program = trace(of_scalars(lambda x: x * (jnp.sqrt(2.0) / 3.0)))
    assert program.steps == (Step("mul", (0, np.sqrt(2.0) / 3.0)),)


def test_halves_are_products():
    program = trace(of_scalars(lambda x: x / 2.0 + x / -0.25 + x / 3.0))
    assert [s.operands for s in program.steps if s.operation == "mul"] == [(0.5, 0), (-4.0, 0)]
    assert operations(program).count("div") == 1


def test_minus_zero_is_not_zero():
    program = trace(of_scalars(lambda x: jnp.arctan2(x, 0.0) + jnp.arctan2(x, -0.0)))
    assert operations(program).count("atan2") == 2


def test_the_author_names_the_values():
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


def test_names_are_found_through_helpers():
    def call(alpha):
        bounded = _at_least(alpha)
        square = _squared(bounded)
        compiled = _compiled(square)
        first, second = compiled + 1.0, compiled + 2.0
        return first / second

    # The name inside a helper is nearer to the value than the one outside; trace(…) itself is
    # called in an assignment too, and gives no name.
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
def test_what_cannot_be_written_is_refused_by_name(name):
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
def test_results_are_what_the_function_says(call, result, message):
    with pytest.raises(ValueError, match=message):
        trace(of_scalars(call, "x", result))


def test_a_loop_without_end_is_cut_short():
    def call(x):
        return lax.fori_loop(0, 1_000_000, lambda i, t: t * x + 0.5, x)

    with pytest.raises(ValueError, match="more than 100 steps"):
        trace(of_scalars(call), limit=100)


def test_every_operation_is_rounded_to_half():
    function = of_scalars(lambda x, y: jnp.sqrt(x * y + 0.1) / 3.0, "x y")
    rows = np.random.default_rng(3).uniform(0, 1, (200, 2))
    x, y = rows.astype(np.float16).T
    product = (x.astype(np.float64) * y).astype(np.float16)
    total = (product.astype(np.float64) + np.float16(0.1)).astype(np.float16)
    root = np.sqrt(total.astype(np.float64)).astype(np.float16)
    expected = (root.astype(np.float64) / 3.0).astype(np.float16)
    given_back = evaluate(trace(function), rows, np.float16)
    assert given_back.dtype == np.float16
    np.testing.assert_array_equal(given_back[:, 0], expected)


def test_a_constant_result_is_given_for_every_point():
    values = evaluate(trace(of_scalars(lambda x: (x, jnp.asarray(0.25)), "x", 2)), np.ones((3, 1)))
    np.testing.assert_array_equal(values, [[1.0, 0.25]] * 3)


def test_a_program_is_interpreted_over_other_numbers():
    program = trace(of_scalars(lambda x, y: x * y - 0.5, "x y"))
    table = {
        "mul": lambda a, b: (
            min(p * q for p in a for q in b),
            max(p * q for p in a for q in b),
        ),
        "sub": lambda a, b: (a[0] - b[1], a[1] - b[0]),
    }
    assert interpret(program, [(1.0, 2.0), (-3.0, 4.0)], table, lambda c: (c, c)) == ((-6.5, 7.5),)
    with pytest.raises(ValueError, match="operation 'sub' in Example has no meaning here"):
        interpret(program, [1.0, 1.0], {"mul": lambda a, b: a * b}, float)


@pytest.mark.parametrize("shape", [(3,), (3, 2), (3, 1, 1)])
def test_inputs_of_another_shape_are_refused(shape):
    with pytest.raises(ValueError, match="inputs"):
        evaluate(trace(of_scalars(jnp.sin)), np.zeros(shape))


def test_inputs_are_named_and_grouped():
    parameters = (Parameter("c", (0.0, 1.0), size=2), Parameter("x", (0.0, 1.0)))
    function = Function("F", "F.", parameters, None, "r", lambda c, x: c[0] + c[1] * x)
    assert input_names(function) == ("c[0]", "c[1]", "x")
    assert group_inputs(function, [1, 2, 3]) == ((1, 2), 3)
    assert trace(function).inputs == ("c[0]", "c[1]", "x")
    with pytest.raises(ValueError, match="F was given 2 inputs; allowed: 3"):
        group_inputs(function, [1, 2])


BAD = {
    "no identifier": lambda: Parameter("2x", (0.0, 1.0)),
    "Greek": lambda: Parameter("θ", (0.0, 1.0)),
    "empty domain": lambda: Parameter("x", (1.0, 0.0)),
    "infinite domain": lambda: Parameter("x", (0.0, float("inf"))),
    "no domain": lambda: Parameter("x", (float("nan"), 1.0)),
    "no size": lambda: Parameter("x", (0.0, 1.0), size=0),
    "no result": lambda: Function("F", "F.", (), 0, "r", lambda: ()),
    "function name": lambda: Function("a b", "F.", (), None, "r", lambda: 0.0),
    "twice": lambda: of_scalars(jnp.add, "x x"),
    "result is input": lambda: Function(
        "F", "", (Parameter("r", (0.0, 1.0)),), 1, "r", lambda r: (r,)
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_a_function_that_makes_no_sense_is_refused(name):
    with pytest.raises(ValueError, match="allowed: "):
        BAD[name]()


def test_a_program_is_plain_data():
    program = trace(of_scalars(lambda x: x + 1.0))
    assert program == Program("Example", ("x",), (Step("add", (0, 1.0)),), (1,))
    assert {program: 1}[program] == 1
