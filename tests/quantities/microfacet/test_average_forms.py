"""Forms of E_avg: the constant of its expansion, and what is built in."""

import numpy as np
import pytest

from fitting import form_values
from integrals import GGX_AVERAGE_ALBEDO as AVERAGE
from quantities.microfacet.average_forms import C0, average_form, candidates


def test_the_constant_is_that_of_the_expansion():
    assert pytest.approx(0.48923536890796534, rel=1e-15) == C0
    alpha = 0.002
    lost = 1 - float(AVERAGE.value(alpha))
    # The next term is α⁴ (½ ln(1/α) − 0.94).
    expected = C0 + alpha**2 * (0.5 * np.log(1 / alpha) - 0.9406)
    assert lost / alpha**2 - np.log(1 / alpha) == pytest.approx(expected, abs=1e-7)


@pytest.mark.parametrize(("above", "below"), [(2, 0), (3, 2), (4, 1)])
def test_with_the_logarithm_the_relative_error_of_what_is_lost_vanishes(above, below):
    form = average_form(structure="log", above=above, below=below)
    fitted = form.fitted(np.full(form.size, 0.3))
    lost = [(1 - float(fitted(a))) / (a * a * (np.log(1 / a) + C0)) for a in (1e-2, 1e-3, 1e-4)]
    assert np.abs(np.array(lost) - 1).max() < 2e-3
    assert abs(lost[1] - 1) < 0.1 * abs(lost[0] - 1)


def test_the_forms_are_their_equations():
    c, alpha = np.array([0.2, -0.1, 0.3, 0.4]), np.linspace(0.01, 1, 7)
    r = (0.2 - 0.1 * alpha) / (1 + 0.3 * alpha + 0.4 * alpha**2)
    for structure, expected in (
        ("free", 1 - alpha**2 * r),
        ("log", 1 - alpha**2 * (C0 - np.log(alpha) + alpha * r)),
    ):
        form = average_form(structure=structure, above=2, below=2)
        np.testing.assert_allclose(
            form_values(form.fitted(c), alpha[:, None]), expected, rtol=1e-14
        )


def test_candidates_have_no_more_operations_than_fit_a_shader():
    assert max(form.size for form in candidates()) <= 8
    assert len({(f.shape["structure"], f.size, f.shape["below"]) for f in candidates()}) == len(
        list(candidates())
    )
