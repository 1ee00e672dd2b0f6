"""Forms of Q: what is built in at zero density."""

import numpy as np
import pytest

from coefficients.catalogue import resolve
from fitting import form_values
from fitting.linearity import linear_parts
from fitting.proofs.least_error import least_error
from quantities.fuzz.q_forms import pole_q


@pytest.mark.parametrize("structure", ["one", "slope", "log"])
def test_value_and_slope_at_zero_density_are_exact_where_they_are_built_in(structure):
    form = pole_q(structure=structure, terms=2, poles=0 if structure == "log" else 1)
    fitted = form.fitted(form.starts[0] + 0.02 * np.cos(np.arange(form.size)))
    assert float(fitted(0.0)) == 1.0
    if structure != "one":
        slope = (float(fitted(1e-9)) - 1) / 1e-9
        assert slope == pytest.approx(-2, abs=1e-6)


def test_poles_must_stay_on_the_far_side_of_zero_density():
    form = pole_q(structure="free", terms=1, poles=2)
    c = np.array([0.1, 1.0, 0.3, 2.0, -0.1])
    assert float(form.proofs.positive(c, 0.2)) == pytest.approx(-0.1 - 5e-4)


@pytest.mark.parametrize("structure", ["free", "one", "slope"])
@pytest.mark.parametrize(("terms", "poles"), [(0, 1), (1, 2), (3, 2), (0, 3)])
def test_a_sum_of_poles_is_a_quotient_of_polynomials(structure, terms, poles):
    form = pole_q(structure=structure, terms=terms, poles=poles)
    fitted = form.fitted(0.3 + 0.1 * np.arange(form.size))
    quotient = form.proofs.quotient(fitted)
    points = np.linspace(0, 0.5, 11)[:, None]
    np.testing.assert_allclose(form_values(quotient, points), form_values(fitted, points), 1e-13)
    assert linear_parts(form, points) is None or (poles == 1 and terms == 0)
    assert linear_parts(quotient.form, points) is not None


def test_a_sum_of_poles_has_a_lower_bound_of_its_largest_error():
    """Its own best coefficients attain it nearly, and no others are below."""
    entry = resolve("best/q-4")
    fitted = entry.require_fitted()
    points = np.concatenate([np.linspace(0, 1, 2001)[:, None] ** 2, [[1.0]]]) / 2
    exact = fitted.reference.values(points)
    bound = least_error(fitted, points, exact)
    largest = np.abs(form_values(fitted, points) - exact).max()
    assert 0.999 * largest < bound <= largest
    random = np.random.default_rng(7)
    for step in random.normal(size=(200, 3)) * 1e-3:
        other = fitted.form.fitted(fitted.constants * (1 + step))
        assert np.abs(form_values(other, points) - exact).max() >= bound
