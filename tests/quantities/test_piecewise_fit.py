"""Fits of the piecewise-linear NDF: better than uniform knots, exact in what they promise."""

import numpy as np
import pytest

from quantities.piecewise.fit import fit_ndf, masking_error, total_variation
from quantities.piecewise.knots import equidistributed_knots
from quantities.piecewise.linear_fit import TRADE
from quantities.piecewise.targets import analytic_ndf, measured_ndf
from shading.piecewise.moments import mass, moment, normalised
from shading.piecewise.ndf import profile, uniform_knots


def ggx_g1(width, angles):
    return 2 / (1 + np.sqrt(1 + (width * np.tan(angles)) ** 2))


def uniform(target, segments):
    """Return the NDF of the paper: linear in the angle, at uniform knots, normalised."""
    knots = uniform_knots(segments)
    return normalised(profile(knots, target.of(knots), "angle"))


@pytest.mark.slow
@pytest.mark.parametrize("name", ["ggx:0.05", "beckmann:0.1"])
def test_the_total_variation_is_ten_times_smaller_than_with_uniform_knots(name):
    target = analytic_ndf(name)
    fit = fit_ndf(target, 32)
    # 28 and 54 times were measured.
    assert fit.total_variation < total_variation(uniform(target, 32), target) / 10
    np.testing.assert_allclose(fit.total_variation, total_variation(fit.profile, target), rtol=1e-9)
    np.testing.assert_allclose(mass(fit.profile), 1, rtol=1e-12)


@pytest.mark.slow
def test_masking_of_ggx_is_that_of_its_formula():
    target = analytic_ndf("ggx:0.1")
    fit = fit_ndf(target, 32)
    # 4.4e-7 was measured; uniform knots have 1.9e-3, and 12 times the total variation.
    assert fit.total_variation < total_variation(uniform(target, 32), target) / 10
    assert fit.masking_error < 3e-6
    angles = np.linspace(0.01, 1.57, 50)
    exact = np.cos(angles) * (1 / ggx_g1(0.1, angles) - 1)
    np.testing.assert_allclose(target.hidden_areas(angles), exact, rtol=1e-8)
    assert masking_error(uniform(target, 32), target) > 1.5e-3
    # ∫ D sin²θ dθ = α/4
    np.testing.assert_allclose(moment(fit.profile), 0.1 / 4, rtol=1e-6)


@pytest.mark.slow
def test_a_fit_is_monotone_if_asked():
    target = analytic_ndf("student-t:0.2,3")
    fit = fit_ndf(target, 12, monotone=True)
    assert (np.diff(fit.profile.values) <= 1e-9).all()
    assert fit.masking_error < 1e-4


@pytest.mark.slow
@pytest.mark.parametrize("variable", ["angle", "cos2"])
@pytest.mark.parametrize("name", ["ggx:0.3", "beckmann:0.3", "student-t:0.1,4"])
def test_other_targets(name, variable):
    target = analytic_ndf(name)
    fit = fit_ndf(target, 16, variable=variable)
    old = uniform(target, 16)
    assert fit.total_variation < total_variation(old, target)
    assert fit.masking_error < masking_error(old, target) / 10


def test_knots_that_miss_the_peak_are_refused():
    with pytest.raises(ValueError, match=r"miss the peak: the interpolated NDF has the mass 3\.47"):
        fit_ndf(analytic_ndf("ggx:0.05"), variable="angle", knots=uniform_knots(10))
    with pytest.raises(ValueError, match="miss the peak"):
        fit_ndf(analytic_ndf("ggx:0.02"), 4)


def test_knots_increase_and_are_dense_at_the_peak():
    knots = equidistributed_knots(analytic_ndf("beckmann:0.05").of, 32)
    assert (np.diff(knots) > 0).all()
    assert (knots < 0.2).sum() > 20
    with pytest.raises(ValueError, match="2 and more"):
        equidistributed_knots(analytic_ndf("ggx:0.1").of, 1)


@pytest.mark.slow
def test_measured_samples(tmp_path):
    theta = np.linspace(0, 80, 90)
    truth = analytic_ndf("ggx:0.3")
    rows = [
        f"{t:.6f},{17 * d:.12g}" for t, d in zip(theta, truth.of(np.radians(theta)), strict=True)
    ]
    path = tmp_path / "lobe.csv"
    path.write_text("\n".join(["angle,density", *rows[::-1]]) + "\n")
    target = measured_ndf(path, "angle", "density", degrees=True)
    # The mass undoes the unknown unit, but for what is beyond 80 degrees.
    np.testing.assert_allclose(target.mass, 17, rtol=2e-3)
    fit = fit_ndf(target, 24)
    assert fit.target == "lobe.csv"
    assert total_variation(fit.profile, truth) < 5e-3
    assert fit.masking_error < 1e-4


@pytest.mark.parametrize(
    ("rows", "said"),
    [
        (["0,1", "0.5,1", "1,0.5"], "at least 4"),
        (["0,1", "30,1", "60,0.5", "90,0"], "allowed are those from 0 to π/2"),
        (["0,1", "0.5,1", "0.5,0.5", "1,0"], "an angle twice"),
        (["0,1", "0.5,-1", "0.6,0.5", "1,0"], "numbers ≥ 0"),
    ],
)
def test_bad_samples_are_refused(tmp_path, rows, said):
    path = tmp_path / "bad.csv"
    path.write_text("\n".join(["theta,D", *rows]) + "\n")
    with pytest.raises(ValueError, match=said):
        measured_ndf(path)


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("ggx", "is no NDF: allowed are ggx:WIDTH"),
        ("phong:3", "is no NDF"),
        ("ggx:0.1,2", "is anisotropic: allowed here is one width"),
        ("ggx:0.1,2,3", "is no NDF"),
        ("ggx:0.001", "allowed are 0.005 to 2"),
        ("student-t:0.1,1.2", "allowed are 1.6 to 1000"),
    ],
)
def test_unknown_targets_are_refused(name, said):
    with pytest.raises(ValueError, match=said):
        analytic_ndf(name)


def test_the_masking_may_cost_no_more_total_variation_than_stated():
    assert TRADE == 1.25
