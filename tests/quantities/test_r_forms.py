"""Forms of R: symmetry and the isotropic limit."""

import numpy as np
import pytest

from quantities import problem
from quantities.fuzz.r_forms import VARIABLES, candidates


@pytest.mark.parametrize("variable", VARIABLES)
def test_r_is_a_half_for_isotropic_layers_and_the_same_for_both_ends_of_a_fibre(variable):
    shape = {
        "variable": variable,
        "numerator": [[0, 0], [0, 1], [2, 1]],
        "denominator": [[1, 0], [1, 1]],
        "least_alpha": 0.15,
    }
    fitted = (
        problem("r").find_form("monomial-r", shape).fitted(np.array([0.3, -0.2, 0.1, 0.4, 0.2]))
    )
    assert float(fitted(1.0, 0.7)) == 0.5
    assert float(fitted(0.3, 0.7)) == pytest.approx(float(fitted(0.3, np.pi - 0.7)), rel=1e-14)


def test_a_form_is_restricted_to_its_least_alpha():
    shape = {"variable": "1-alpha", "numerator": [[0, 0]], "denominator": [], "least_alpha": 0.5}
    assert problem("r").find_form("monomial-r", shape).axes[0].domain == "[0.5, 1]"


def test_known_forms_are_tried_first():
    form = problem("r").default
    assert next(candidates(0.15, (form,))) is form
