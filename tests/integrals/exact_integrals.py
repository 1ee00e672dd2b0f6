"""Integrals over (0, 1) with known values: smooth ones and hard ones, with a place a in (0, 1)."""

from collections.abc import Callable
from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from scipy.special import erf

from integrals import Axis

PLACE = Axis(name="a", symbol="a", unit="1", lower=0.0, upper=1.0, meaning="place of the feature")

WIDTH = 1e-3


class Known(NamedTuple):
    """An integrand f(t, a), its integral as a function of a, and the error that may be stated."""

    integrand: Callable
    exact: Callable
    largest_error: float


def _gaussian(t, a):
    return jnp.exp(-(((t - a) / WIDTH) ** 2) / 2)


def _area(a):
    scale = WIDTH * np.sqrt(2)
    return WIDTH * np.sqrt(np.pi / 2) * (erf((1 - a) / scale) + erf(a / scale))


INTEGRALS = {
    "smooth": Known(lambda t, a: jnp.exp(t * a), lambda a: np.expm1(a) / a, 1e-12),
    "kink": Known(lambda t, a: jnp.abs(t - a), lambda a: (a * a + (1 - a) ** 2) / 2, 1e-12),
    "end kink": Known(lambda t, a: jnp.sqrt(t), lambda a: 2 / 3 + 0 * a, 1e-12),
    "1/√t": Known(lambda t, a: 1 / jnp.sqrt(t), lambda a: 2 + 0 * a, 1e-6),
    "1/√(1 − t)": Known(lambda t, a: 1 / jnp.sqrt(1 - t), lambda a: 2 + 0 * a, 1e-5),
    "1/√|t − a|": Known(
        lambda t, a: 1 / jnp.sqrt(jnp.abs(t - a)), lambda a: 2 * (np.sqrt(a) + np.sqrt(1 - a)), 0.1
    ),
    # Stronger singularities converge too slowly. The stated error has to say so.
    "t^−0.9": Known(lambda t, a: t**-0.9, lambda a: 10 + 0 * a, np.inf),
    "t^−0.99": Known(lambda t, a: t**-0.99, lambda a: 100 + 0 * a, np.inf),
    "logarithm": Known(lambda t, a: jnp.log(t), lambda a: -1 + 0 * a, 1e-12),
    "peak": Known(_gaussian, _area, 1e-12),
    "peak on a plateau": Known(lambda t, a: 1 + _gaussian(t, a), lambda a: 1 + _area(a), 1e-12),
    "peak and 1/√t": Known(
        lambda t, a: 1 / jnp.sqrt(t) + _gaussian(t, a), lambda a: 2 + _area(a), 1e-6
    ),
    "layer at the end": Known(lambda t, a: jnp.exp(-t / (1e-5 * a)), lambda a: 1e-5 * a, 1e-12),
    "cos 60t": Known(lambda t, a: jnp.cos(60 * t), lambda a: np.sin(60) / 60 + 0 * a, 1e-12),
    "cos 6000t": Known(
        lambda t, a: jnp.cos(6000 * t), lambda a: np.sin(6000) / 6000 + 0 * a, np.inf
    ),
    "jump": Known(lambda t, a: jnp.where(t < a, 1.0, 0.0), lambda a: a, 1e-9),
    "two jumps": Known(
        lambda t, a: jnp.where(jnp.abs(t - 0.5) < a / 2, t, 0.0), lambda a: a / 2, 1e-6
    ),
    "zero": Known(lambda t, a: 0.0 * t, lambda a: 0 * a, 1e-300),
}

PLANE = {
    "smooth": Known(
        lambda x, y, a: jnp.exp(x * a + y), lambda a: np.expm1(a) / a * np.expm1(1), 1e-12
    ),
    "kink along the diagonal": Known(lambda x, y, a: jnp.abs(x - y), lambda a: 1 / 3 + 0 * a, 1e-4),
    "kink along an axis": Known(
        lambda x, y, a: jnp.abs(x - a) * y, lambda a: (a * a + (1 - a) ** 2) / 4, 1e-6
    ),
    "jump across": Known(lambda x, y, a: jnp.where(x + y < a, 1.0, 0.0), lambda a: a * a / 2, 0.1),
    "disc": Known(
        lambda x, y, a: jnp.where(x * x + y * y < a * a, 1.0, 0.0), lambda a: np.pi * a * a / 4, 0.1
    ),
    "singular sides": Known(lambda x, y, a: 1 / jnp.sqrt(x * y), lambda a: 4 + 0 * a, 0.5),
    "singular corner": Known(lambda x, y, a: 1 / (x + y), lambda a: 2 * np.log(2) + 0 * a, 1e-5),
}
