"""Q, the cosine-weighted average of P_p over the hemisphere of lights.

P_p = exp(−d/(u·n)) is the probability that light reaches the base unscattered.
Q(d) = (1/π) ∫_Ω P_p(u) (u·n) dω_u (Eq. 4), which is 2 E₃(d).
"""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from integrals.fuzz.g import DENSITY
from integrals.monte_carlo import Sequence, mean_estimate, unit_points
from integrals.reference import Estimate, Reference, leg
from integrals.rules.interval import checked_steps, exponential_decay
from integrals.sampling import Sampling
from integrals.special.exponential import e3
from shading import penetration
from shading.types import Scalar

AXES = (DENSITY,)


def average_penetration(density: Scalar) -> Array:
    """Return Q = 2 E₃(d) for d ≥ 0."""
    return 2 * e3(density)


@leg(*AXES)
def closed_form(density) -> Estimate:
    """Evaluate 2 E₃(d). Its error is at most 16ε, with ε of float64."""
    return Estimate(average_penetration(density), jnp.full((), 16 * np.finfo(float).eps))


@leg(*AXES)
def quadrature(density, *, step: float = 1 / 32) -> Estimate:
    """Integrate P_p over the hemisphere by the double exponential rule with `step`.

    P_p does not depend on the azimuth. It changes rapidly near u·n ~ d. In the variable
    s = −ln(u·n) this change has a width of about one, however small d is.
    """

    def rule(step: float) -> Array:
        s, weights = exponential_decay(step)
        cosines = jnp.exp(-s)
        return 2 * jnp.sum(
            weights * cosines**2 * jax.vmap(penetration, (0, None))(cosines, density)
        )

    return checked_steps(rule, step, 1e-14)


@leg(*AXES)
def monte_carlo(
    density, *, samples: int = 1 << 16, sequence: Sequence = "random", seed: int = 0
) -> Estimate:
    """Average P_p over lights that are drawn with the density (u·n)/π per steradian."""
    cosines = jnp.sqrt(1 - unit_points(samples, 1, sequence, seed)[..., 0])
    values = jax.vmap(jax.vmap(penetration, (0, None)), (0, None))(cosines, density)
    return mean_estimate(values)


Q = Reference(
    name="q",
    symbol="Q",
    meaning="cosine-weighted average of the chance to penetrate the layer unscattered",
    definition="(1/π) ∫_Ω exp(−d/(u·n)) (u·n) dω_u",
    axes=(replace(DENSITY, scale="square"),),
    sampling=Sampling(fitted=11, checked=13, judged=16),
    closed_form=closed_form,
    quadrature=quadrature,
    monte_carlo=monte_carlo,
    few_calls=True,
)
