"""A polynomial with simple poles: values, starts, a proven fit, and what is refused."""

import numpy as np
import pytest

from fitting.fit import fit
from fitting.linearity import positive_of
from fitting.shapes import pole_sum
from tests.fitting.lines import LINE
from tests.fitting.toys import TOY


def test_a_pole_sum_has_its_value_names_and_text():
    form = pole_sum(LINE, 2, 1, name="p", of=lambda eta: eta - 1)
    assert form.coefficient_names == ["c0", "c1", "a1", "b1", "a2", "b2"]
    assert form.equation == "z = η − 1; f = c0 + c1·z + a1/(b1 + z) + a2/(b2 + z)"
    c = np.array([0.5, 2.0, 1.0, 0.25, -1.0, 3.0])
    z = 0.7
    expected = 0.5 + 2 * z + 1 / (0.25 + z) - 1 / (3 + z)
    assert float(form(c, 1 + z)) == pytest.approx(expected, rel=1e-14)


@pytest.mark.parametrize("poles", [1, 3, 6])
def test_poles_start_below_the_domain(poles):
    for of in (None, lambda eta: -10 * eta):
        form = pole_sum(LINE, poles, 0, name="p", of=of)
        assert len(form.starts) == 3
        for start in form.starts:
            positive = positive_of(form)
            assert all(float(positive(start, eta)) > 0 for eta in np.linspace(1, 3, 9))


def test_a_fit_is_proven_to_have_no_pole():
    found = fit(pole_sum(LINE, 1, 1, name="p"))
    assert found.certificate.holds
    assert found.off_grid.largest < 0.02
    b = float(np.asarray(found.fitted.coefficients)[3])
    # The denominator is least at η = 1.
    assert found.certificate.bound == pytest.approx(b + 1, rel=0.11)


def test_what_is_no_pole_sum_is_refused():
    with pytest.raises(ValueError, match="p has the variables x, y: allowed is one, by of=…"):
        pole_sum(TOY, 1, 0, name="p")
    with pytest.raises(ValueError, match="p: 0 poles, degree -1: it has no coefficients"):
        pole_sum(LINE, 0, -1, name="p")
    assert pole_sum(TOY, 1, 0, name="p", of=lambda x, y: x + y).size == 3
    assert pole_sum(LINE, 0, 2, name="p").starts == ()
