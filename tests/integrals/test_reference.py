"""What all integrals promise: exact answers by every leg, domains, arguments, float64."""

import functools

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from integrals import PS, REFERENCES, Axis, Estimate
from integrals.reference import require_float64
from tests.integrals.problems import PROBLEMS, RIGHT

# A correct Monte Carlo estimate is further off once in 1.7 million trials.
STANDARD_ERRORS = 5
# The exact answers are themselves evaluated in float64, to a few roundings of 1.
PROBLEM_ROUNDING = 1e-15

LEGS = [(name, leg) for name, reference in REFERENCES.items() for leg in reference.legs]
INSIDE = {
    "ps": (0.5, 0.6, 0.7, 0.8),
    "g": (0.5, 0.6),
    "q": (0.5,),
    "r": (0.5, 0.6),
    "velvet": (-0.5,),
}


@functools.cache
def evaluator(name, leg):
    return jax.jit(REFERENCES[name].legs[leg])


@pytest.mark.parametrize(("name", "leg"), LEGS)
def test_every_leg_gives_the_known_values_within_its_stated_error(name, leg):
    allowed = STANDARD_ERRORS if leg == "monte_carlo" else 1
    problems = [problem for problem in PROBLEMS if problem.integral == name]
    assert problems
    for problem in problems:
        value, error = evaluator(name, leg)(*map(float, problem.arguments))
        miss = abs(float(value) - problem.exact)
        assert miss <= allowed * float(error) + PROBLEM_ROUNDING, (problem, value, error)


@pytest.mark.parametrize(("name", "leg"), LEGS)
def test_stated_errors_are_small(name, leg):
    """No leg buys its honesty with an error that says nothing."""
    value, error = evaluator(name, leg)(*INSIDE[name])
    assert isinstance(evaluator(name, leg)(*INSIDE[name]), Estimate)
    assert 0 < float(error) < (5e-3 if leg == "monte_carlo" else 1e-12)
    assert 0 < float(value) < 1


@pytest.mark.parametrize(("name", "leg"), LEGS)
def test_every_leg_is_nan_outside_the_domain(name, leg):
    reference = REFERENCES[name]
    for index, axis in enumerate(reference.axes):
        above = np.nextafter(axis.upper, np.inf)
        at_lower = axis.lower if axis.open_below else np.nextafter(axis.lower, -np.inf)
        for bad in (at_lower, above, -7.0, np.nan, np.inf, -np.inf):
            arguments = list(INSIDE[name])
            arguments[index] = float(bad)
            value, error = evaluator(name, leg)(*arguments)
            # XLA flushes subnormal numbers to zero, which is in a closed domain.
            if not 0 < abs(bad) <= np.finfo(float).tiny:
                assert np.isnan(value), (axis.name, bad, value)
                assert np.isnan(error), (axis.name, bad, error)


@pytest.mark.parametrize(("name", "leg"), LEGS)
def test_every_leg_is_finite_at_the_ends_of_the_domain(name, leg):
    reference = REFERENCES[name]
    for index, axis in enumerate(reference.axes):
        ends = [axis.lower + 1e-3 if axis.open_below else axis.lower, min(axis.upper, 1e300)]
        for end in ends:
            arguments = list(INSIDE[name])
            arguments[index] = end
            value, error = evaluator(name, leg)(*arguments)
            assert np.isfinite(value), (axis.name, end)
            assert np.isfinite(error), (axis.name, end)


@pytest.mark.parametrize(("name", "leg"), LEGS)
def test_wrong_number_of_arguments_is_refused(name, leg):
    names = ", ".join(axis.name for axis in REFERENCES[name].axes)
    for arguments in (INSIDE[name][:-1], (*INSIDE[name], 0.5)):
        with pytest.raises(ValueError, match=f"{len(arguments)} arguments.*{names}"):
            REFERENCES[name].legs[leg](*arguments)


@pytest.mark.parametrize(("name", "leg"), LEGS)
def test_float32_is_refused(name, leg):
    with jax.enable_x64(False), pytest.raises(RuntimeError, match="need float64"):
        REFERENCES[name].legs[leg](*INSIDE[name])


def test_float64_is_accepted():
    require_float64()
    assert PS.value(*INSIDE["ps"]).dtype == jnp.float64


@pytest.mark.parametrize("name", ["ps", "g", "q"])
def test_legs_take_integers_and_work_under_vmap(name):
    reference, one = REFERENCES[name], [1] * len(REFERENCES[name].axes)
    points = jnp.array([one, INSIDE[name]], float).T
    batch = jax.jit(jax.vmap(reference.closed_form))(*points)
    assert batch.value.dtype == jnp.float64
    alone = [evaluator(name, "closed_form")(*map(float, point)).value for point in points.T]
    # A batch may be compiled to other fused operations, no more.
    np.testing.assert_allclose(batch.value, alone, rtol=1e-14)
    np.testing.assert_allclose(evaluator(name, "closed_form")(*one).value, alone[0], rtol=1e-14)


def test_best_leg_is_the_most_exact_one():
    assert {name: reference.best_leg for name, reference in REFERENCES.items()} == {
        "ps": "closed_form",
        "g": "closed_form",
        "q": "closed_form",
        "r": "quadrature",
        "velvet": "closed_form",
    }
    assert REFERENCES["q"].value(0.5) == REFERENCES["q"].closed_form(0.5).value


def test_missing_leg_is_none():
    assert REFERENCES["r"].closed_form is None
    assert list(REFERENCES["r"].legs) == ["quadrature", "monte_carlo"]


HALF_OPEN = Axis("alpha", "α", "1", 0.0, 1.0, "", open_below=True)
UNBOUNDED = Axis("density", "d", "1", 0.0, np.inf, "")


def test_domain_is_written_as_an_interval():
    assert HALF_OPEN.domain == "(0, 1]"
    assert UNBOUNDED.domain == "[0, ∞)"
    assert Axis("theta", "θ", "rad", 0.0, RIGHT, "").domain == "[0, 1.5708]"


@pytest.mark.parametrize(
    ("axis", "inside", "outside"),
    [
        (HALF_OPEN, [1e-300, 0.5, 1.0], [0.0, -0.5, np.nextafter(1, 2), np.nan, np.inf]),
        (UNBOUNDED, [0.0, 1.0, 1e308], [-1e-300, np.nan, np.inf, -np.inf]),
    ],
)
def test_axis_checks_its_domain(axis, inside, outside):
    assert axis.contains(np.array(inside)).all()
    assert not axis.contains(np.array(outside)).any()
    for value in inside:
        assert axis.check(value) == value
    for value in outside:
        with pytest.raises(ValueError, match=rf"{axis.name} = .* outside its domain [(\[]0, "):
            axis.check(value)


def test_error_for_an_angle_names_the_unit():
    with pytest.raises(ValueError, match=r"theta_f = 45 rad is .* \[0, 1\.5708\] rad$"):
        REFERENCES["r"].axes[1].check(45.0)
