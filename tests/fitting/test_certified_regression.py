"""Least squares reach the certified solutions of NIST's nonlinear regression problems."""

import numpy as np
import pytest

from fitting import Goal, form_values
from fitting.solvers.exchange import Exchange
from fitting.uncertainty import uncertainty
from tests.fitting.nist import NAMES, certified

# Certified values have 11 digits. Where the sum of squares is flat, float64 leaves fewer.
DIGITS, DIGITS_OF_DEVIATIONS = 8, 6
# The hardest of each kind are in the default tests.
QUICK = ("BoxBOD", "ENSO", "Hahn1", "Lanczos2", "MGH09", "MGH10", "Rat43", "Thurber")
PROBLEMS = [n if n in QUICK else pytest.param(n, marks=pytest.mark.slow) for n in NAMES]


def digits(found: np.ndarray, expected: np.ndarray) -> float:
    return float(-np.log10(np.max(np.abs(found / expected - 1))))


@pytest.mark.parametrize("name", NAMES)
def test_the_data_have_the_certified_sum_of_squares(name):
    problem = certified(name, 1)
    error = form_values(problem.form.fitted(problem.coefficients), problem.sample.points)
    squares = float(np.sum((error - problem.y) ** 2))
    if name == "Lanczos1":  # its residuals are below the rounding of the printed coefficients
        assert squares < 1e-18
    else:
        assert squares == pytest.approx(problem.squares, rel=1e-9)


@pytest.mark.parametrize("start", [1, 2])
@pytest.mark.parametrize("name", PROBLEMS)
def test_both_published_starts_lead_to_the_certified_coefficients(name, start):
    problem = certified(name, start)
    found, converged, words = Exchange().least_squares(problem.form, problem.sample, Goal())
    assert converged and words == "trust region (SciPy)"
    assert digits(found, problem.coefficients) > DIGITS
    if start == 2 and name != "Lanczos1":
        known = uncertainty(problem.form.fitted(found), problem.sample)
        assert digits(known.standard_errors, problem.deviations) > DIGITS_OF_DEVIATIONS
        assert known.unique and not known.undetermined


@pytest.mark.parametrize("name", ["Hahn1", "Kirby2", "MGH09", "Thurber"])
def test_quotients_need_no_start(name):
    """MGH09 has a product of coefficients in its numerator: it is no quotient of linear ones."""
    problem = certified(name)
    if name == "MGH09":
        with pytest.raises(ValueError, match="mgh09 has no starts: give one"):
            Exchange().least_squares(problem.form, problem.sample, Goal())
        return
    found, converged, _ = Exchange().least_squares(problem.form, problem.sample, Goal())
    assert converged
    assert digits(found, problem.coefficients) > DIGITS
