"""Forms of Q: what is built in at zero density."""

import numpy as np
import pytest

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
    assert float(form.proofs.positive(c, 0.2)) == -0.1
