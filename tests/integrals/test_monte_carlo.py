"""Monte Carlo: reproducible, unbiased, and with standard errors that are right."""

import functools
import inspect

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from integrals import REFERENCES
from integrals.monte_carlo import SCRAMBLINGS, indicator, mean_estimate, unit_points

POINTS = {
    "ps": (0.3, 0.7, 0.5, 1.0),
    "g": (0.5, 0.6),
    "q": (0.7,),
    "r": (0.3, 0.7),
    "velvet": (-0.6,),
}
SEEDS, FEW, MANY = range(24), 1 << 10, 1 << 14


def estimates(monkeypatch, name, sequence, samples):
    """Return values and standard errors, (seeds,) each, of one quantity at one point.

    The leg is compiled once. The points of each seed replace those that it would draw itself.
    """
    reference, point = REFERENCES[name], POINTS[name]
    dimensions = {"ps": 2, "g": 1, "q": 1, "r": 4, "velvet": 2}[name]
    draws = np.stack([unit_points(samples, dimensions, sequence, seed) for seed in SEEDS])

    def estimate(points):
        monkeypatch.setattr(f"integrals.fuzz.{name}.unit_points", lambda *arguments: points)
        return reference.monte_carlo(*point, samples=samples, sequence=sequence)

    values, errors = jax.jit(lambda draws: jax.lax.map(estimate, draws))(draws)
    monkeypatch.undo()
    return np.asarray(values), np.asarray(errors)


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=pytest.mark.slow if n in ("r", "g") else ()) for n in POINTS]
)
def test_stated_errors_are_right_and_decrease_at_the_expected_rate(monkeypatch, name):
    rates, last, truth = {}, {}, float(jax.jit(REFERENCES[name].value)(*POINTS[name]))
    for sequence in ("random", "sobol"):
        value, error = estimates(monkeypatch, name, sequence, FEW)
        miss = value - truth
        assert np.all(abs(miss) <= 5 * error)
        # The root mean square of 24 normal scores is outside 1 ± 0.5 once in 2000 trials.
        assert 0.5 < np.sqrt(np.mean((miss / error) ** 2)) < 1.5
        assert miss.min() < 0 < miss.max()
        first = np.sqrt(np.mean(miss**2))
        value, error = estimates(monkeypatch, name, sequence, MANY)
        miss = value - truth
        assert np.all(abs(miss) <= 5 * error)
        last[sequence] = np.sqrt(np.mean(miss**2))
        rates[sequence] = np.log(last[sequence] / first) / np.log(MANY / FEW)
    # 24 seeds give a standard deviation to 15%, and so the exponent over a factor of 16 to 0.08.
    assert abs(rates["random"] + 0.5) < 0.15
    # The error of a count falls about like N^-(1/2 + 1/(2D)), where D is 2 for P_s and 4 for R.
    assert rates["sobol"] < -0.55
    assert last["sobol"] < (0.85 if name == "r" else 0.45) * last["random"]


@pytest.mark.parametrize("sequence", ["random", "sobol"])
def test_estimates_depend_on_the_seed_only(sequence):
    leg = functools.partial(REFERENCES["g"].monte_carlo, 0.5, 0.6, sequence=sequence, samples=256)
    unit_points.cache_clear()
    first = leg(seed=1)
    unit_points.cache_clear()
    assert leg(seed=1) == first
    assert leg(seed=2).value != first.value


@pytest.mark.parametrize(("sequence", "replicates"), [("random", 1), ("sobol", SCRAMBLINGS)])
def test_points_fill_the_unit_cube_evenly(sequence, replicates):
    points = unit_points(1 << 12, 3, sequence, 0)
    assert points.shape == (replicates, (1 << 12) // replicates, 3)
    assert points.min() >= 0
    assert points.max() < 1
    for axis in range(3):
        counts, _ = np.histogram(points[..., axis], 8, (0, 1))
        # 512 points are expected in each interval, and 5 standard deviations are 106. Each Sobol'
        # sequence of 128 points has exactly 16 in each.
        assert np.all(abs(counts - 512) <= (0 if sequence == "sobol" else 106))


@pytest.mark.parametrize(
    ("samples", "sequence", "message"),
    [
        (1, "random", "samples = 1: at least 2"),
        (0, "random", "samples = 0: at least 2"),
        (-5, "random", "samples = -5: at least 2"),
        (0, "sobol", "samples = 0: .* 32 times a power of two"),
        (16, "sobol", "samples = 16: .* 32 times a power of two"),
        (100, "sobol", "samples = 100: .* 32 times a power of two"),
    ],
)
def test_impossible_sample_counts_are_refused(samples, sequence, message):
    with pytest.raises(ValueError, match=message):
        unit_points(samples, 2, sequence, 0)


def test_unknown_sequence_is_refused_by_name():
    # The type checks that the tests add would refuse it first, so they are removed.
    with pytest.raises(ValueError, match="sequence = 'halton': allowed are 'random' and 'sobol'"):
        inspect.unwrap(unit_points)(64, 2, "halton", 0)


def test_standard_error_is_that_of_the_independent_means():
    values = np.random.default_rng(0).normal(size=(1, 1000))
    value, error = mean_estimate(jnp.array(values))
    np.testing.assert_allclose(value, values.mean(), atol=1e-15)
    np.testing.assert_allclose(error, values.std(ddof=1) / np.sqrt(1000), rtol=1e-12)
    value, error = mean_estimate(jnp.array(values.reshape(10, 100)))
    means = values.reshape(10, 100).mean(1)
    np.testing.assert_allclose(error, means.std(ddof=1) / np.sqrt(10), rtol=1e-12)


def test_indicator_is_zero_or_one_and_has_no_derivative():
    np.testing.assert_array_equal(indicator(jnp.array([-1.0, 0.0, 1e-300, 2.0])), [0, 0, 1, 1])
    for mode in (jax.grad, jax.jacfwd):
        with pytest.raises(TypeError, match="no derivative"):
            mode(indicator)(jnp.array(0.5))
