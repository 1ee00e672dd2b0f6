"""What a form is: an approximant whose array leaves are its coefficients."""

from abc import abstractmethod
from typing import ClassVar

import equinox as eqx
import numpy as np
from jax import Array

from integrals import Axis, Integral


class Form(eqx.Module):
    """An approximant of one integral; calling it evaluates one point.

    Concrete forms are final. `coefficients` is the only leaf; a
    NumPy array makes them constants of a trace. `axes` are the integral's,
    restricted to the domain that the form is fitted on, `equation` says where it is printed.
    """

    coefficients: Array | np.ndarray

    name: ClassVar[str]
    equation: ClassVar[str]
    integral: ClassVar[Integral]
    axes: ClassVar[tuple[Axis, ...]]

    @abstractmethod
    def __call__(self, *arguments) -> Array:
        """Evaluate the form at one point of its axes, scalars in radians where the unit is so."""

    @classmethod
    @abstractmethod
    def coefficient_names(cls) -> list:
        """Name the coefficients, nested as they are."""
