"""What a form is: an approximant whose array leaves are its coefficients."""

from abc import abstractmethod
from collections.abc import Callable
from typing import Any, ClassVar

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jax import Array

from integrals import Axis, Integral


class Form(eqx.Module):
    """An approximant of one integral; calling it evaluates one point.

    Concrete forms are final. `coefficients` is the only leaf; a
    NumPy array makes them constants of a trace. `axes` are the integral's,
    restricted to the domain that the form is fitted on, `equation` says where it is printed.
    `shape` tells the members of a family of forms apart (fitting/families); the paper's have none.
    """

    coefficients: Array | np.ndarray

    name: ClassVar[str]
    equation: ClassVar[str]
    integral: ClassVar[Integral]
    axes: ClassVar[tuple[Axis, ...]]
    shape: ClassVar[dict[str, Any] | None] = None

    @abstractmethod
    def __call__(self, *arguments) -> Array:
        """Evaluate the form at one point of its axes, scalars in radians where the unit is so."""

    @classmethod
    @abstractmethod
    def coefficient_names(cls) -> list:
        """Name the coefficients, nested as they are."""

    @classmethod
    def starts(cls) -> list[np.ndarray]:
        """Give coefficients to start a fit from; none of them is a published table's."""
        return []

    @classmethod
    def linear_parts(cls, *arguments) -> tuple[Array, Array, Array, Array] | None:
        """Give a₀, a, b₀, b with the form (a₀ + a·c)/(b₀ + b·c) at one point, if it is such."""
        return None

    def relaxed(self) -> tuple[Callable[..., Array], tuple[Axis, ...]] | None:
        """Give a function of more freedom, and its axes, that has all values of the form.

        What is shown of its denominators holds for the form's.
        """
        return None

    def margins(self) -> tuple[Callable[..., tuple[Array, ...]], tuple[Axis, ...]] | None:
        """Give what is nowhere negative only if all values are from 0 to 1, and its axes.

        None where nothing is known that is easier to bound than the values themselves.
        """
        return None

    def positive(self, *arguments) -> Array:
        """Give what must stay positive at one point for the form to have no pole and no NaN."""
        return jnp.ones(())
