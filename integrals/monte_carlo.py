"""Random and Sobol' points of the unit cube, and estimates of means from them."""

import functools
from typing import Literal

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from integrals.reference import Estimate

Sequence = Literal["random", "sobol"]

# A Sobol' estimate averages this many independently scrambled sequences. The standard deviation of
# their means gives the standard error.
SCRAMBLINGS = 32


@functools.lru_cache(maxsize=8)
def unit_points(samples: int, dimensions: int, sequence: Sequence, seed: int) -> np.ndarray:
    """Return points (replicates, n, dimensions) of the unit cube, where replicates · n = samples.

    'random' has one replicate of independent points. 'sobol' has 32 replicates, each an
    independently Owen-scrambled Sobol' sequence. The same arguments give the same points. Raises
    ValueError if `samples` does not suit the sequence: 'random' needs at least two, and 'sobol' 32
    times a power of two.
    """
    if sequence == "random":
        if samples < 2:
            raise ValueError(f"samples = {samples}: at least 2 are needed for a standard error")
        return np.random.default_rng(seed).random((1, samples, dimensions))
    if sequence == "sobol":
        from scipy.stats import qmc  # noqa: PLC0415  it takes a second to import

        exponent = round(np.log2(samples / SCRAMBLINGS)) if samples > 0 else -1
        if exponent < 0 or SCRAMBLINGS << exponent != samples:
            raise ValueError(
                f"samples = {samples}: a Sobol' estimate takes {SCRAMBLINGS} times a power of two"
            )
        seeds = np.random.SeedSequence(seed).spawn(SCRAMBLINGS)
        return np.stack(
            [
                qmc.Sobol(dimensions, rng=np.random.default_rng(child)).random_base2(exponent)
                for child in seeds
            ]
        )
    raise ValueError(f"sequence = {sequence!r}: allowed are 'random' and 'sobol'")


def mean_estimate(values: Array) -> Estimate:
    """Return the mean of values (replicates, n) and its standard error.

    With one replicate, the single values are independent. With several replicates, only their means
    are, and the standard error is computed from these.
    """
    independent = values[0] if values.shape[0] == 1 else values.mean(axis=1)
    count = independent.shape[0]
    return Estimate(independent.mean(), jnp.std(independent, ddof=1) / np.sqrt(count))


@jax.custom_jvp
def indicator(condition: Array) -> Array:
    """Return 1.0 where `condition` > 0, and 0.0 elsewhere. Its derivative raises TypeError.

    A count of samples is a piecewise constant function of the parameters. Its derivative is zero
    almost everywhere, and so it is wrong as an estimate of the derivative of the integral.
    """
    return jnp.where(condition > 0, 1.0, 0.0)


@indicator.defjvp
def _refuse(primals, tangents):
    raise TypeError(
        "a Monte Carlo count has no derivative: differentiate the closed form or the quadrature"
    )
