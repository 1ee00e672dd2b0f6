"""Sample points of the unit cube, plain and low-discrepancy, and estimates from them."""

import functools
from typing import Literal

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from integrals.reference import Estimate

Sequence = Literal["random", "sobol"]

# Independent scramblings whose spread gives the standard error of a Sobol' estimate.
SCRAMBLINGS = 32


@functools.lru_cache(maxsize=8)
def unit_points(samples: int, dimensions: int, sequence: Sequence, seed: int) -> np.ndarray:
    """Give points (replicates, n, dimensions) of the unit cube, replicates · n = samples.

    'random' is one replicate of independent draws; 'sobol' is 32 Owen-scrambled Sobol' sequences,
    independent of one another. The same arguments give the same points. Raises ValueError for a
    sample count that the sequence cannot have.
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
    """Give the mean of values (replicates, n) and its standard error.

    With one replicate the draws are independent; with several, the replicates' means are.
    """
    independent = values[0] if values.shape[0] == 1 else values.mean(axis=1)
    count = independent.shape[0]
    return Estimate(independent.mean(), jnp.std(independent, ddof=1) / np.sqrt(count))


@jax.custom_jvp
def indicator(condition: Array) -> Array:
    """Give 1.0 where `condition` > 0, else 0.0; refuses to be differentiated.

    A count of samples is piecewise constant in the parameters: its derivative is zero almost
    everywhere and says nothing of the integral's.
    """
    return jnp.where(condition > 0, 1.0, 0.0)


@indicator.defjvp
def _refuse(primals, tangents):
    raise TypeError(
        "a Monte Carlo count has no derivative: differentiate the closed form or the quadrature"
    )
