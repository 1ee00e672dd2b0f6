"""Array types that the annotations share."""

from jax.typing import ArrayLike
from jaxtyping import Float, Real

Scalar = Real[ArrayLike, ""]
Vector = Float[ArrayLike, "3"]
Matrix = Float[ArrayLike, "3 3"]
