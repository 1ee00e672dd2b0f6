"""Forms as values: one stage or two, coefficients in shape or flat, and the traced program."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from fitting import Form, Stage, plain_form
from fitting.form import traced
from integrals import Axis
from integrals.reference import restricted
from programs import evaluate
from tests.fitting.toys import AXES, PLANE, TOY, toy_form
from tests.soft_step import SOFT

# A material's two numbers first, then a direction's value.
TWO_STAGES = Form(
    name="two-stages",
    equation="m₀ + m₁ y²",
    reference=TOY,
    axes=AXES,
    coefficient_names=[["m0: 1", "m0: x"], ["m1: 1", "m1: x"]],
    stages=(
        Stage(lambda c, x: (c[0][0] + c[0][1] * x, c[1][0] + c[1][1] * x)),
        Stage(lambda m, square: jnp.asarray(m[0] + m[1] * square)),
    ),
    shared=1,
    inputs=lambda x, y: (y * y,),
)
ROWS = np.array([[1.0, 2.0], [-3.0, 0.5]])


def test_a_form_of_one_stage_calls_it_with_coefficients_and_point():
    assert float(PLANE(np.array([1.0, 2.0, 3.0]), 0.5, -1.0)) == 1 + 2 * 0.5 - 3
    assert (PLANE.size, PLANE.coefficient_shape) == (3, (3,))


def test_the_second_stage_takes_the_results_of_the_first_and_its_own_inputs():
    x, y = 0.5, 2.0
    assert TWO_STAGES.first(ROWS, x) == (1 + 2 * x, -3 + 0.5 * x)
    assert float(TWO_STAGES(ROWS, x, y)) == (1 + 2 * x) + (-3 + 0.5 * x) * y * y
    assert (TWO_STAGES.size, TWO_STAGES.coefficient_shape) == (4, (2, 2))


@pytest.mark.parametrize("given", [ROWS, ROWS.ravel(), jnp.asarray(ROWS)])
def test_coefficients_are_given_in_their_shape_or_flat(given):
    fitted = TWO_STAGES.fitted(given)
    np.testing.assert_array_equal(fitted.coefficients, ROWS)
    assert isinstance(fitted.constants, np.ndarray)
    np.testing.assert_array_equal(fitted.constants, ROWS)
    assert float(fitted(0.5, 2.0)) == float(TWO_STAGES(ROWS, 0.5, 2.0))
    assert fitted.first(0.5) == TWO_STAGES.first(ROWS, 0.5)


def test_coefficients_of_another_size_are_refused():
    with pytest.raises(TypeError, match="reshape"):
        TWO_STAGES.fitted(np.ones(5))


def test_a_fitted_form_has_the_axes_and_the_reference_of_its_form():
    fitted = PLANE.fitted(np.ones(3))
    assert (fitted.form, fitted.axes, fitted.reference) == (PLANE, AXES, TOY)


def test_the_coefficients_are_the_only_array_of_a_fitted_form():
    (leaf,) = jax.tree.leaves(PLANE.fitted(np.ones(3)))
    np.testing.assert_array_equal(leaf, np.ones(3))


def test_forms_without_coefficients_have_an_empty_shape():
    constant = toy_form(lambda c, x, y: jnp.asarray(x + y), [])
    assert (constant.size, constant.coefficient_shape) == (0, (0,))
    assert float(constant.fitted(np.zeros(0))(0.25, 0.5)) == 0.75


def test_a_traced_form_is_a_program_of_the_axes():
    fitted = TWO_STAGES.fitted(ROWS)
    program = traced(fitted, fitted, fitted.axes)
    points = np.random.default_rng(1).uniform(0, 1, (20, 2))
    assert (program.name, program.inputs) == ("toy", ("x", "y"))
    expected = [float(fitted(*point)) for point in points]
    np.testing.assert_allclose(evaluate(program, points)[:, 0], expected, rtol=1e-15)


def test_a_function_of_other_axes_can_be_traced_for_proofs():
    fitted = TWO_STAGES.fitted(ROWS)
    square = Axis("square", 0.0, 4.0, "y²")
    constants = fitted.constants

    def both(x, y2):
        m = TWO_STAGES.first(constants, x)
        return m[0] + m[1] * y2, m[0]

    program = traced(fitted, both, (AXES[0], square), 2)
    assert program.inputs == ("x", "square")
    np.testing.assert_allclose(evaluate(program, np.array([[0.5, 4.0]])), [[2 - 11, 2]])


def test_a_plain_function_is_a_form_whose_arguments_tell_axes_from_coefficients():
    def bent(a, x, b, y):
        """S = a x/(1 + b y)"""
        return a * x / (1 + b * y)

    form = plain_form(bent, SOFT)
    assert form.coefficient_names == ["a", "b"]
    assert form.name == "bent"
    assert form.equation == "S = a x/(1 + b y)"
    assert float(form(jnp.array([3.0, 0.5]), 2.0, 0.8)) == pytest.approx(6 / 1.4, rel=1e-15)
    restricted_axes = restricted(SOFT.axes, x=(1.0, 2.0))
    other = plain_form(bent, SOFT, [1.0, 0.2], "other-name", restricted_axes)
    assert other.axes[0].lower == 1.0
    assert other.name == "other-name"
    np.testing.assert_array_equal(other.starts[0], [1.0, 0.2])


def test_a_plain_function_that_is_no_form_is_refused():
    with pytest.raises(ValueError, match="flat does not take 'y'"):
        plain_form(lambda x, a: a * x, SOFT, name="flat")
    with pytest.raises(ValueError, match="flat: 2 starts given for 1 coefficients"):
        plain_form(lambda x, y, a: a * x * y, SOFT, [1.0, 2.0], name="flat")
