"""Rows of offset + factor · (t + pᵀx)/(1 + qᵀy), where x and y are features of the point."""

from collections.abc import Callable
from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array


@dataclass(frozen=True, eq=False)
class Quotients:
    """One quotient with coefficients (k,), or several of one shape with coefficients (rows, k).

    * `features`: maps a point to x (m,). The numerator takes all `above` = m features; the
      denominator takes the first `below` of them, which are y.
    * `factor`: maps a point to the number before the quotient.
    * `offset`: a number for one quotient, or a tuple with a number for each row.
    * `least`: a lower limit of the denominators of rows, so that none is rounded to zero in half
      precision; None: there is no limit.

    A row of the coefficients holds t, then p₁ … pₘ, then q₁ … q_below.
    """

    features: Callable[..., Array]
    factor: Callable[..., Array]
    offset: float | tuple[float, ...]
    above: int
    below: int
    least: float | None = None

    def __call__(self, coefficients: Array | np.ndarray, *point) -> Array:
        """Evaluate the quotient, or all rows (rows,), at one point."""
        x, factor = self.features(*point), self.factor(*point)
        c, split = coefficients, self.above + 1
        if isinstance(self.offset, float):
            above, below = c[1:split] @ x, c[split:] @ x[: self.below]
            return self.offset + factor * (c[0] + above) / (1 + below)
        # The rows' numerators and denominators keep these names in exported code.
        numerator = c[:, 0] + c[:, 1:split] @ x
        denominator = 1 + c[:, split:] @ x[: self.below]
        if self.least is not None:
            denominator = jnp.maximum(denominator, self.least)
        return jnp.array(self.offset) + factor * numerator / denominator

    def positive(self, coefficients: Array | np.ndarray, *point) -> Array:
        """Return the denominator at one point, or the least of the rows' denominators."""
        y = self.features(*point)[: self.below]
        return jnp.min(1 + jnp.asarray(coefficients)[..., self.above + 1 :] @ y)

    def columns(self, points: Array) -> tuple[Array, Array, Array]:
        """Return (1, x) (n, 1 + m), y (n, below) and the factor (n,) at points (n, axes)."""
        x = jax.vmap(lambda point: self.features(*point))(points)
        factor = jax.vmap(lambda point: self.factor(*point))(points)
        return jnp.concatenate([jnp.ones((len(x), 1)), x], axis=1), x[:, : self.below], factor
