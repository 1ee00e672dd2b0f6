"""The examples of problem files: they load, and give what they say."""

from pathlib import Path

import mpmath as mp
import numpy as np
import pytest

from fitting import Goal
from fitting.fit import fit
from quantities.loader import load_problems
from quantities.registry import unregister

EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.fixture
def fresnel():
    (problem,) = load_problems(str(EXAMPLES / "fresnel.py"))
    yield problem
    unregister(problem.name)


def average_reflectance(eta: float) -> float:
    """F_avg by mpmath, from Fresnel's two reflectances and Snell's law."""
    n = mp.mpf(eta)

    def weighted(mu):
        inside = mp.sqrt(1 - (1 - mu * mu) / (n * n))
        s = (mu - n * inside) / (mu + n * inside)
        p = (inside - n * mu) / (inside + n * mu)
        return (s * s + p * p) * mu

    return float(mp.quad(weighted, [0, 0.01, 0.1, 0.5, 1]))


def test_the_average_reflectance_is_exact(fresnel):
    etas = np.array([[1.05], [1.33], [1.5], [2.4]])
    found = fresnel.reference.estimates(etas)
    exact = [average_reflectance(float(eta)) for (eta,) in etas]
    np.testing.assert_allclose(found.value, exact, rtol=0, atol=1e-12)
    assert np.all(np.abs(np.asarray(found.value) - exact) <= np.asarray(found.error) + 1e-15)


@pytest.mark.slow
def test_a_quotient_of_the_average_reflectance_has_an_error_of_two_ten_thousandths(fresnel):
    made = fit(fresnel.default, Goal("linf"))
    assert made.off_grid.largest < 2.3e-4
    assert made.certificate.holds
