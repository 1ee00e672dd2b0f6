"""A quadrature rule for the hemisphere of directions about the z axis."""

import functools

import numpy as np

from integrals.rules.interval import exponential_decay

# The step of the rule in −ln cos θ, and its number of azimuths. With these `fuzz.radiance` has an
# error below 1e-5 for α ≥ 0.15, d ≥ 0.01 and v·n ≥ 0.1 (tests/integrals/test_radiance.py).
STEP = 1 / 12
AZIMUTHS = 192


@functools.cache
def hemisphere_rule(step: float = STEP, azimuths: int = AZIMUTHS) -> tuple[np.ndarray, np.ndarray]:
    """Return directions (n, 3) and weights (n,) in steradians that integrate over the hemisphere.

    The rule in s = −ln cos θ is the double exponential one with the given `step`. It resolves
    integrands that change near cos θ ~ d, however small d is. In azimuth it is the midpoint rule.
    """
    s, weights = exponential_decay(step)
    cosine = np.exp(-s)
    sine = np.sqrt(-np.expm1(-2 * s))
    phi = (np.arange(azimuths) + 0.5) * 2 * np.pi / azimuths
    x, y = np.outer(sine, np.cos(phi)), np.outer(sine, np.sin(phi))
    z = np.broadcast_to(cosine[:, None], x.shape)
    solid = np.repeat(weights * cosine * 2 * np.pi / azimuths, azimuths)
    return np.stack([x, y, z], axis=-1).reshape(-1, 3), solid
