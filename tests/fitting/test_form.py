"""Forms as values: one stage or two, coefficients in their shape or flat, traced programs."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from fitting import Form, Stage, plain_form
from fitting.fit import fit
from fitting.form import traced, unguarded
from integrals import Axis
from integrals.reference import restricted
from programs import evaluate
from tests.fitting.toys import AXES, PLANE, TOY, toy_form

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
    assert (program.name, program.inputs) == ("form", ("x", "y"))
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


# Forms of plain functions


def tilted(x, y, at_zero, slope):
    """at_zero + slope·x + y

    Further lines say more.
    """
    return at_zero + slope * x + y


def test_arguments_named_like_axes_are_axes_and_the_rest_are_coefficients():
    form = plain_form(tilted, TOY, start=[1.0, -2.0])
    assert (form.name, form.equation) == ("tilted", "at_zero + slope·x + y")
    assert (form.coefficient_names, form.axes) == (["at_zero", "slope"], AXES)
    assert float(form.fitted(np.array([3.0, 0.5]))(0.5, 2.0)) == 3 + 0.25 + 2
    (start,) = form.starts
    np.testing.assert_array_equal(start, [1, -2])


def test_the_order_of_the_arguments_does_not_matter():
    form = plain_form(lambda c1, y, c0, x: c0 * x + c1 * y, TOY, name="turned")
    assert (form.name, form.coefficient_names, form.starts) == ("turned", ["c1", "c0"], ())
    assert float(form.fitted(np.array([10.0, 1.0]))(0.5, 2.0)) == 20.5


def test_a_plain_form_can_be_fitted_and_restricted():
    upper = restricted(AXES, y=(0.0, 2.0))
    form = plain_form(tilted, TOY, axes=upper)
    found = fit(form, nodes=9)
    assert found.fitted.axes == upper
    assert found.solver == "QR"
    assert found.certificate.holds


def test_a_function_without_a_docstring_is_described_by_its_name():
    form = plain_form(lambda x, y, c0: c0 + x + y, TOY, name="bare")
    assert form.equation == "bare"


@pytest.mark.parametrize(
    ("function", "start", "message"),
    [
        (lambda x, c0: c0 * x, [], "does not take y: allowed are the axes x, y, and then"),
        (lambda x, y, c0: c0 * x, [1.0, 2.0], "2 starts given for 1 coefficients"),
    ],
)
def test_a_plain_function_that_is_no_form_is_refused(function, start, message):
    with pytest.raises(ValueError, match=message):
        plain_form(function, TOY, start=start, name="lonely")


def test_an_unguarded_form_may_be_stepped_anywhere():
    assert float(unguarded(np.ones(3), 0.5)) == 1
