"""Array types for annotations: a scalar, a vector (3,) and a matrix (3, 3)."""

from jax.typing import ArrayLike
from jaxtyping import Float, Real

Scalar = Real[ArrayLike, ""]
Vector = Float[ArrayLike, "3"]
Matrix = Float[ArrayLike, "3 3"]
