"""The scaled Bessel function e^(−z) I₀(z), with derivatives that are exact for large z too."""

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jaxtyping import Float

# From here on, this many terms of the asymptotic series are exact to rounding.
_LARGE, _TERMS = 400.0, 8


def _coefficients() -> np.ndarray:
    """Return (1·3·5…(2k − 1))²/(k! 8ᵏ), the coefficients of z⁻ᵏ."""
    k = np.arange(1, _TERMS)
    return np.concatenate([[1.0], np.cumprod((2 * k - 1) ** 2 / (8 * k))])


def series_of_i0(inverse: Float[Array, "..."]) -> Array:
    """Return √(2πz) e^(−z) I₀(z) for 1/z = `inverse` ≤ 1/400, by its asymptotic series."""
    return jnp.polyval(jnp.asarray(_coefficients()[::-1]), jnp.asarray(inverse))


def scaled_i0(z: Float[Array, "..."]) -> Array:
    """Return e^(−z) I₀(z) for z ≥ 0.

    JAX's i0e has the derivative e^(−z) (I₁ − I₀), which loses all digits for z > 1e16, and the
    derivative 0 at z = 0 instead of the one-sided −1.
    """
    z = jnp.asarray(z, float)
    large = jnp.maximum(z, _LARGE)
    small = jnp.minimum(z, _LARGE) + 1e-300
    return jnp.where(
        z > _LARGE,
        series_of_i0(1 / large) / jnp.sqrt(2 * jnp.pi * large),
        jax.scipy.special.i0e(small),
    )
