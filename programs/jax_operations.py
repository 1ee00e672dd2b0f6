"""The operations of a program as JAX functions, with which a program is evaluated under JAX."""

from collections.abc import Callable
from typing import Any

import jax.numpy as jnp

from programs.operations import OPERATIONS

# The names of jax.numpy's functions where they differ from those of the operations.
_NAMES = {
    "add": jnp.add,
    "sub": jnp.subtract,
    "mul": jnp.multiply,
    "div": jnp.divide,
    "neg": jnp.negative,
    "abs": jnp.abs,
    "sqrt": jnp.sqrt,
    "rsqrt": lambda x: 1 / jnp.sqrt(x),
    "min": jnp.minimum,
    "max": jnp.maximum,
    "lt": jnp.less,
    "le": jnp.less_equal,
    "gt": jnp.greater,
    "ge": jnp.greater_equal,
    "eq": jnp.equal,
    "ne": jnp.not_equal,
    "and": jnp.logical_and,
    "or": jnp.logical_or,
    "not": jnp.logical_not,
    "select": jnp.where,
    "pow": jnp.power,
    "asin": jnp.arcsin,
    "acos": jnp.arccos,
    "atan": jnp.arctan,
    "atan2": jnp.arctan2,
}
JAX_OPERATIONS: dict[str, Callable[..., Any]] = {
    name: _NAMES.get(name) or getattr(jnp, name) for name in OPERATIONS
}
