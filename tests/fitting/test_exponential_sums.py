"""Sums of exponentials: values, starts, a fit that finds known coefficients, what is refused."""

from dataclasses import replace

import jax.numpy as jnp
import numpy as np
import pytest

from fitting.fit import fit
from fitting.shapes import exponentials
from integrals import Axis, Estimate
from tests.fitting.lines import LINE, operations
from tests.fitting.toys import TOY


def test_a_sum_of_exponentials_has_its_value_names_and_text():
    form = exponentials(LINE, 2, name="e", constant=True)
    assert form.coefficient_names == ["c0", "a1", "b1", "a2", "b2"]
    assert form.equation == "f = c0 + a1·exp(−b1·η) + a2·exp(−b2·η)"
    c = np.array([0.25, 2.0, 0.5, -3.0, 4.0])
    expected = 0.25 + 2 * np.exp(-0.5 * 1.7) - 3 * np.exp(-4 * 1.7)
    assert float(form(c, 1.7)) == pytest.approx(expected, rel=1e-14)


def test_a_fit_finds_the_exponentials_that_made_the_data():
    made = replace(
        LINE,
        axes=(Axis("x", 0.0, 2.0),),
        closed_form=lambda x: Estimate(
            0.1 + 2 * jnp.exp(-x) + 0.5 * jnp.exp(-6 * x), jnp.full((), 1e-15)
        ),
    )
    found = fit(exponentials(made, 2, name="e", constant=True))
    c0, *pairs = np.asarray(found.fitted.coefficients)
    slow, fast = sorted(np.reshape(pairs, (2, 2)), key=lambda pair: pair[1])
    np.testing.assert_allclose([c0, *slow, *fast], [0.1, 2, 1, 0.5, 6], rtol=1e-6)


@pytest.mark.parametrize(("lower", "upper"), [(0.0, 2.0), (1000.0, 1001.0), (0.0, np.inf)])
def test_starts_do_not_overflow_and_fit_the_width(lower, upper):
    reference = replace(LINE, axes=(Axis("x", lower, upper),))
    for terms in (1, 4):
        form = exponentials(reference, terms, name="e")
        for start in form.starts:
            assert np.isfinite(start).all()
            assert (start[1::2] > 0).all()
            assert float(form(start, lower)) == pytest.approx(1) or lower > 100


def test_a_monotone_sum_is_positive_and_falls_whatever_the_coefficients():
    form = exponentials(LINE, 2, name="e", constant=True, monotone=True)
    assert form.equation == "f = c0² + a1²·exp(−b1²·η) + a2²·exp(−b2²·η)"
    for c in np.random.default_rng(4).normal(size=(20, 5)):
        values = [float(form(c, eta)) for eta in (1.0, 1.5, 3.0)]
        assert values[0] > values[1] > values[2] > 0
        expected = c[0] ** 2 + sum(a * a * np.exp(-b * b * 1.5) for a, b in (c[1:3], c[3:]))
        assert values[1] == pytest.approx(expected, rel=1e-14)
    assert all((start > 0).all() for start in form.starts)
    # The squares of constants are constants: the code of the form costs no more.
    c = np.array([0.1, 1.0, 2.0, 0.5, 1.5])
    assert operations(form, c) == operations(exponentials(LINE, 2, name="e", constant=True), c)


def test_the_coefficients_may_be_polynomials_of_another_axis():
    form = exponentials(TOY, 1, name="e", degree=2, along="x", constant=True)
    assert form.coefficient_names == [
        f"{part}_{k}" for part in ("c0", "a1", "b1") for k in range(3)
    ]
    c, (x, y) = np.random.default_rng(5).normal(size=9), (0.3, -0.7)
    at = [np.polyval(part[::-1], y) for part in np.reshape(c, (3, 3))]
    assert float(form(c, x, y)) == pytest.approx(at[0] + at[1] * np.exp(-at[2] * x), rel=1e-13)


def test_a_fit_finds_amplitudes_and_rates_that_depend_on_another_axis():
    made = replace(
        TOY,
        closed_form=lambda x, y: Estimate(
            (1 + 0.5 * y) * jnp.exp(-(2 + 0.3 * y) * x), jnp.full((), 1e-15)
        ),
    )
    found = fit(exponentials(made, 1, name="e", degree=1))
    np.testing.assert_allclose(found.fitted.coefficients, [1, 0.5, 2, 0.3], rtol=1e-6)


@pytest.mark.parametrize(
    ("reference", "options", "message"),
    [
        (TOY, {"monotone": True}, "e has the axes x, y: monotone allows one axis"),
        (TOY, {"along": "z"}, "e: along = 'z': allowed are x, y"),
        (LINE, {"terms": 0}, "e: terms = 0, degree 0: at least 1 and 0 are needed"),
        (LINE, {"degree": 1}, "e: degree = 1: there is no axis but eta"),
    ],
)
def test_what_is_no_sum_of_exponentials_is_refused(reference, options, message):
    with pytest.raises(ValueError, match=message):
        exponentials(reference, **{"terms": 2, "name": "e", **options})
