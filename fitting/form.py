"""What a form is: an approximant whose array leaves are its coefficients."""

from abc import abstractmethod
from collections.abc import Callable
from typing import Any, ClassVar

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jax import Array

from integrals import Axis, Integral
from programs.function import Function, Parameter
from programs.program import Program
from programs.tracing.tracer import trace


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

    def unguarded(self) -> tuple[Callable[..., Array], tuple[Axis, ...]]:
        """Give a function that is the form, and its axes, for proofs that it has no pole.

        It is without the floors that keep a denominator of the form from being zero.
        """
        return self, self.axes

    def margins(self) -> tuple[Callable[..., tuple[Array, ...]], tuple[Axis, ...]] | None:
        """Give what is nowhere negative only if all values are from 0 to 1, and its axes.

        None where nothing is known that is easier to bound than the values themselves.
        """
        return None

    def positive(self, *arguments) -> Array:
        """Give what must stay positive at one point for the form to have no pole and no NaN."""
        return jnp.ones(())


def box_of(axes: tuple[Axis, ...]) -> np.ndarray:
    """Give the ends (axes, 2) of a domain."""
    return np.array([(axis.lower, axis.upper) for axis in axes])


def as_program(form: Form) -> Program:
    """Trace a form, its coefficients constants, as a function of its axes."""
    return traced(form, constant(form), form.axes)


def constant(form: Form) -> Form:
    """Give the form with coefficients that are constants of a trace."""
    return type(form)(np.asarray(form.coefficients))


def traced(form: Form, call, axes: tuple[Axis, ...], results: int | None = None) -> Program:
    """Trace a function of a form on some axes: of a scalar, or of a tuple of `results`."""
    parameters = tuple(Parameter(axis.name, (axis.lower, axis.upper)) for axis in axes)
    summary = f"{form.integral.symbol} by {form.equation}"
    return trace(Function(form.integral.name, summary, parameters, results, "value", call))
