"""The examples of problem files: they load, and give what they say."""

from pathlib import Path

import mpmath as mp
import numpy as np
import pytest

from coefficients.catalogue import Entry, resolve
from coefficients.exported_code import operations_of
from fitting import Goal, judge
from fitting.fit import Fit, fit
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


def fitted(problem: str, form: str, **goal) -> Fit:
    (found,) = load_problems(str(EXAMPLES / problem))
    unregister(found.name)
    return fit(found.find_form(form), Goal(**goal))


@pytest.mark.slow
def test_a_quotient_of_the_average_reflectance_has_an_error_below_one_ten_thousandth(fresnel):
    made = fit(fresnel.find_form("rational-3-1"), Goal("linf"))
    assert made.off_grid.largest < 1.0e-4
    assert made.least_error > 0.999 * made.off_grid.largest
    entry = Entry("made", "file", fresnel, None, made.fitted)
    assert operations_of(entry) == 11
    published = judge(resolve("published/fresnel").require_fitted())
    assert published.largest == pytest.approx(6.5e-3, rel=0.02)


@pytest.mark.slow
def test_a_quotient_of_the_albedo_of_ggx_is_better_than_the_published_one():
    made = fitted("ggx_albedo.py", "biquadratic", norm="linf", rounding="float16")
    assert made.fitted.form.size == 17
    assert made.off_grid.largest < 1.15e-2
    assert np.all(np.abs(made.fitted.constants) < 60)


@pytest.mark.slow
def test_the_albedo_of_ggx_is_exact():
    """1 − μ ln(1 + 1/μ) at α = 1, and 30-digit values of the same integral elsewhere."""
    (problem,) = load_problems(str(EXAMPLES / "ggx_albedo.py"))
    unregister(problem.name)
    points = np.array([[0.5, 1.0], [0.02, 1.0], [1.0, 1.0]])
    exact = 1 - points[:, 0] * np.log1p(1 / points[:, 0])
    np.testing.assert_allclose(problem.reference.values(points), exact, rtol=0, atol=1e-12)


@pytest.mark.slow
def test_the_measured_albedo_agrees_with_the_integral_within_its_standard_errors():
    (measured,) = load_problems(str(EXAMPLES / "albedo.py"))
    (exact,) = load_problems(str(EXAMPLES / "ggx_albedo.py"))
    for each in (measured, exact):
        unregister(each.name)
    data = measured.reference.data
    rows = slice(0, 100)
    apart = (data.values[rows] - exact.reference.values(data.points[rows])) / data.sigma[rows]
    assert abs(apart.mean()) < 0.4  # Four standard errors of a mean of 100
    assert 0.7 < apart.std() < 1.3


@pytest.mark.slow
def test_every_form_of_the_measured_albedo_is_fitted():
    (problem,) = load_problems(str(EXAMPLES / "albedo.py"))
    unregister(problem.name)
    rms = [fit(form).off_grid.rms for form in problem.forms]
    assert rms == sorted(rms, reverse=True)
    assert rms[-1] < 1e-2


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.py")), ids=lambda path: path.stem)
def test_an_example_is_short(path):
    assert len(path.read_text(encoding="utf-8").splitlines()) <= 60
