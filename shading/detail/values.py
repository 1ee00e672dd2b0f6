"""The type of the operators' arguments: a number, or an array of independent numbers."""

from jax.typing import ArrayLike
from jaxtyping import Real

Values = Real[ArrayLike, "..."]
