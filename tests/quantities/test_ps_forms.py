"""Forms of P_s: symmetries, exact limits, and the margins that prove the range [0, 1]."""

import functools
import itertools

import jax.numpy as jnp
import mpmath
import numpy as np
import pytest

from fitting.form import traced
from fitting.points.scattered import scattered_points
from integrals import PS
from programs import evaluate, trace
from programs.bounding.rounding import chained
from quantities.fuzz.ps import PS as PROBLEM
from quantities.fuzz.ps_forms import cubic_ps, one_root_ps, two_root_ps

FORMS = {
    "one-root": one_root_ps(skew=1, degree=1, least_alpha=0.15),
    "two-root 3": two_root_ps(terms=3, degree=1, least_alpha=0.15),
    "two-root 4": two_root_ps(terms=4, degree=1, least_alpha=0.15),
    "two-root 5": two_root_ps(terms=5, degree=1, least_alpha=0.15),
    "cubic": cubic_ps(steps=0, degree=1, least_alpha=0.15),
}


def some(form):
    """Return the form with coefficients near a start, none of which is zero."""
    return form.fitted(form.starts[0] + 0.02 * np.cos(np.arange(form.size)))


def values(fitted, points) -> np.ndarray:
    return evaluate(traced(fitted, fitted, fitted.axes), np.array(points))[:, 0]


LIGHTS = np.array(list(itertools.product((0.2, 0.7), (0.3, 1.2), (0.4, 1.3), (2.0,))))


@pytest.mark.parametrize("name", FORMS)
def test_forms_keep_the_symmetries_of_the_integral(name):
    fitted = some(FORMS[name])
    expected = values(fitted, LIGHTS)
    mirrored = LIGHTS * [1, 1, 1, -1]
    np.testing.assert_allclose(values(fitted, mirrored), expected, rtol=1e-14)
    # t and −t are one fibre: u·t and n·t change their signs together.
    turned = LIGHTS * [1, -1, 1, 1] + [0, np.pi, 0, np.pi]
    np.testing.assert_allclose(values(fitted, turned), expected, rtol=1e-12)
    isotropic = LIGHTS * [0, 1, 1, 1] + [1, 0, 0, 0]
    np.testing.assert_allclose(values(fitted, isotropic), 0.5, atol=1e-12)
    upright = [(0.2, 0.0, 0.4, phi) for phi in (0.0, 1.0, 3.0)]
    np.testing.assert_allclose(np.ptp(values(fitted, upright)), 0, atol=1e-14)


@pytest.mark.parametrize("name", [name for name in FORMS if name != "one-root"])
def test_p_s_is_exact_at_grazing_light_where_that_is_built_in(name):
    points = np.array(list(itertools.product((0.2, 0.5), (0.4, 1.2), (np.pi / 2,), (0.3, 2.0))))
    found = values(some(FORMS[name]), points)
    np.testing.assert_allclose(found, PS.values(points), atol=1e-9)


def test_steps_of_the_cubics_root_end_at_the_closed_form():
    lights = np.array([(0.3, 0.4, 0.6, 1.0), (0.15, 1.2, 1.1, 3.0), (0.8, 0.1, 0.2, 2.0)])
    largest = []
    for steps in range(4):
        fitted = cubic_ps(steps=steps, degree=-1, least_alpha=0.15).fitted(np.zeros(0))
        largest.append(np.abs(values(fitted, lights) - PS.values(lights)).max())
    assert largest[0] > 1e-4
    assert all(after < 0.1 * before for before, after in itertools.pairwise(largest[:3]))
    assert largest[3] < 1e-9


def two_steps(alpha, theta_f, theta_u, phi):
    """The form with two steps and no coefficients as its docstring defines it, in mpmath."""
    cos, sin, sqrt = mpmath.cos, mpmath.sin, mpmath.sqrt
    b, c = cos(theta_f), cos(theta_u)
    a = sin(theta_f) * sin(theta_u) * cos(phi) + b * c
    kappa = 1 - alpha**2
    sigma2, T, E = 1 - kappa * a * a, kappa * a * b, alpha**2 * c
    S = sqrt(sigma2 * (1 - kappa * b * b))
    e = E / (S + max(S, T) + E)
    h = (S - T) * (1 - e) / 2
    root = h + sqrt(h * h + e)
    for _ in range(2):
        f = root * (root - S + T) * (root + S + T) - E * (1 - root**2)
        root -= f / (3 * root**2 + 2 * (E + 2 * T) * root + T**2 - S**2)
    below = ((root + T) ** 2 - S**2) / root + 2 * (root + T + E)
    return 1 - sqrt((root + c) * (root + E / sigma2)) / below


def test_the_form_of_two_steps_is_computed_without_cancellation():
    """It is the same function as before, and float32 moves its values by less than 1e-6.

    With one step, where σ² and q are differences, it moves them by more than 2e-6.
    """
    precise, plain = (
        cubic_ps(steps=steps, degree=-1, least_alpha=0.05).fitted(np.zeros(0)) for steps in (2, 1)
    )
    points = scattered_points(PS, precise.axes, 12, 3)
    with mpmath.workdps(30):
        exact = [float(two_steps(*map(mpmath.mpf, map(float, each)))) for each in points[:200]]
    np.testing.assert_allclose(values(precise, points[:200]), exact, rtol=2e-14)
    # θf is small and the light is near grazing, where rounding moves values most.
    rng = np.random.default_rng(2)
    low, high = np.array([0.05, 0.005, 1.45, 0.0]), np.array([0.06, 0.04, np.pi / 2, 1.0])
    moved = [_moved(each, rng.uniform(low, high, (40_000, 4))) for each in (precise, plain)]
    assert moved[0] < 1e-6 and moved[1] > 2e-6


def _moved(fitted, points) -> float:
    """Return how far rounding to float32 moves values of the exported functions at most."""
    programs = [trace(each) for each in PROBLEM.calling.functions(fitted)]
    columns = PROBLEM.calling.arguments_at(fitted, points)
    both, inputs = chained(programs), np.concatenate(columns, axis=1).astype(np.float32)
    single = evaluate(both, inputs, np.float32).astype(float)
    return float(np.abs(single - evaluate(both, inputs.astype(float))).max())


# Forms, and how far coefficients are from zero to give values in and out of [0, 1].
WITH_MARGINS = {
    "one root": (one_root_ps(skew=0, degree=1, least_alpha=0.15), 0.5),
    "one root, skew": (one_root_ps(skew=1, degree=1, least_alpha=0.15), 0.5),
    "three terms": (two_root_ps(terms=3, degree=1, least_alpha=0.15), 1.0),
    "four terms": (two_root_ps(terms=4, degree=1, least_alpha=0.15), 1.0),
    "five terms": (two_root_ps(terms=5, degree=1, least_alpha=0.05), 1.0),
    **{
        f"{steps} steps, degree {degree}": (
            cubic_ps(steps=steps, degree=degree, least_alpha=0.05),
            5.0,
        )
        for steps, degree in ((0, -1), (1, -1), (3, -1), (0, 1), (2, 0))
    },
}
QUICK = ("one root", "five terms", "2 steps, degree 0")


@pytest.mark.parametrize(
    "name",
    [
        each if each in QUICK else pytest.param(each, marks=pytest.mark.slow)
        for each in WITH_MARGINS
    ],
)
def test_where_no_margin_is_negative_the_value_is_between_zero_and_one(name):
    """Point by point, for random coefficients: what docs/range.md proves."""
    form, size = WITH_MARGINS[name]
    points = scattered_points(PS, form.axes, 13, 3)
    random, start, proofs = np.random.default_rng(11), form.starts[0], form.proofs

    def at(fitted):
        def three(*x):
            margins = proofs.margins(fitted.constants, *x[:3], jnp.cos(x[3]))
            positive = proofs.positive(fitted.constants, *x)
            return functools.reduce(jnp.minimum, margins, x[0]), fitted(*x), positive

        return evaluate(traced(fitted, three, form.axes, 3), points).T

    good, bad = 0, 0
    for _ in range(3 if len(start) else 1):
        least, found, positive = at(form.fitted(start + size * random.normal(size=len(start))))
        held = (least >= 0) & (positive > 0)
        assert np.all(found[held] >= -1e-12)
        assert np.all(found[held] <= 1 + 1e-12)
        good, bad = good + held.sum(), bad + np.sum(~held & ~((found >= 0) & (found <= 1)))
    assert good > 1000
    # Margins that are always positive would show nothing; the cubic's are about its root alone.
    assert bad > 0 or form.name == "cubic-ps"


@pytest.mark.parametrize("name", FORMS)
def test_proofs_see_the_form_itself_where_no_floor_is_reached(name):
    fitted = some(FORMS[name])
    value = fitted.form.proofs.value
    for alpha, theta_f, theta_u, phi in LIGHTS:
        seen = float(value(fitted.constants, alpha, theta_f, theta_u, np.cos(phi)))
        assert seen == pytest.approx(float(fitted(alpha, theta_f, theta_u, phi)), rel=1e-12)
