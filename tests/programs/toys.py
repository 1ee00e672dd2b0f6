"""Two small functions, and toolchains, for the tests of this folder."""

import jax.numpy as jnp
import pytest

from programs.functions import Function, Parameter
from programs.toolchains import toolchain

UNIT = (0.25, 1.0)
SCALAR = Function(
    "Rational",
    "A rational function.",
    (Parameter("alpha", UNIT), Parameter("d", UNIT)),
    None,
    "result",
    lambda alpha, d: (0.5 + alpha * (0.25 + alpha * d)) / jnp.sqrt(1.0 + d * d),
)
ARRAYS = Function(
    "Scaled",
    "An array in, an array out.",
    (Parameter("c", UNIT, size=2), Parameter("x", UNIT)),
    2,
    "results",
    lambda c, x: (c[0] + c[1] * x, jnp.exp(-c[1]) * x),
)


def ready(language, precision):
    """Return the toolchain of a language, or skip the test if it is not installed."""
    reason = toolchain(language).missing(precision)
    if reason is not None:
        pytest.skip(f"{language} in {precision}: {reason}")
    return toolchain(language)
