"""What a form is: a compact function with coefficients that stands for a quantity."""

import inspect
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jax import Array

from integrals.reference import Axis, Reference
from programs.functions import Function, Parameter
from programs.program import Program
from programs.tracing.tracer import trace


@dataclass(frozen=True)
class Stage:
    """One step in evaluating a form, and the line that describes it in exported code.

    The first stage is called with the coefficients and the values of its axes. The second is called
    with the results of the first, and with the values of its own arguments.
    """

    call: Callable[..., Any]
    summary: str = ""


def unguarded(*_) -> Array:
    """Let a fit step where it will (for `Proofs.positive`): only the certificate excludes poles."""
    return jnp.ones(())


@dataclass(frozen=True)
class Proofs:
    """How proofs see a form, where the form as it is evaluated is hard to bound.

    All functions take the coefficients and a point of `axes` (None: the form's own).

    * `value` is the form without the floors that keep rounding from dividing by zero.
    * `margins` gives a tuple. If no element is negative anywhere, all values are in [0, 1].
    * `positive` gives one number, which a fit keeps positive. None: the least divisor, radicand
      and argument of a logarithm in the form's traced program.
    * `below` takes the fitted form. It returns a lower bound of a quantity that is positive
      only if no value of the form is above the exact one.

    Branch and bound begins with the domain divided into `first_split` pieces along its first sides.
    """

    axes: tuple[Axis, ...] | None = None
    value: Callable[..., Array] | None = None
    margins: Callable[..., tuple[Array, ...]] | None = None
    positive: Callable[..., Array] | None = None
    below: Callable[["FittedForm"], float] | None = None
    first_split: tuple[int, ...] = ()


@dataclass(frozen=True, eq=False)
class Form:
    """An approximant of one quantity: its function, without the values of its coefficients.

    `axes` are the quantity's, restricted to the domain that the form is fitted on. `equation` says
    where the form is printed, or what it is. `coefficient_names` may be nested, and gives the shape
    of the coefficients. `shape` tells the members of a family apart; other forms have none.

    A form has one stage; or two, where much of the work is shared by many points: then the first
    takes the first `shared` axes, and `inputs` maps all axes' values to the second's arguments.

    `starts` are coefficients that a fit may start from; none of them is a published table's.
    `solver` fits the form on a grid; None stands for the general one. `has_least_error` says that a
    lower bound of the largest error is sought where the form is a quotient of linear functions.
    """

    name: str
    equation: str
    reference: Reference
    axes: tuple[Axis, ...]
    coefficient_names: list
    stages: tuple[Stage, ...]
    shared: int = 0
    inputs: Callable[..., tuple[Array, ...]] | None = None
    starts: tuple[np.ndarray, ...] = ()
    shape: dict[str, Any] | None = None
    proofs: Proofs = field(default_factory=Proofs)
    solver: Any = None
    has_least_error: bool = True

    @property
    def coefficient_shape(self) -> tuple[int, ...]:
        """The shape of the coefficients."""
        return np.shape(self.coefficient_names)

    @property
    def size(self) -> int:
        """How many coefficients there are."""
        return int(np.size(self.coefficient_names))

    def __call__(self, coefficients: Array | np.ndarray, *point) -> Array:
        """Evaluate the form at one point, scalars in radians where the unit is so."""
        if self.inputs is None:
            return self.stages[0].call(coefficients, *point)
        inputs = self.inputs(*point)
        return self.stages[1].call(self.first(coefficients, *point[: self.shared]), *inputs)

    def first(self, coefficients: Array | np.ndarray, *shared) -> Any:
        """Evaluate the first stage at the axes that it takes."""
        return self.stages[0].call(coefficients, *shared)

    def fitted(self, coefficients: Array | np.ndarray) -> "FittedForm":
        """Return the form with coefficients, which are in their shape or flat."""
        return FittedForm(self, jnp.asarray(coefficients).reshape(self.coefficient_shape))


def plain_form(
    function: Callable[..., Any],
    reference: Reference,
    start: Sequence[float] = (),
    name: str | None = None,
    axes: tuple[Axis, ...] | None = None,
) -> Form:
    """Make a form of a plain function: arguments named like axes are axes, the rest coefficients.

    Arguments: `start`, coefficients that a fit may start from, none for a form that is a quotient
    of linear functions; `name`, by default the function's; `axes`, those of the reference
    restricted to the form's domain. The first line of the function's docstring is the equation.
    Raises ValueError for a function that does not take every axis, and for a start of another
    length.
    """
    axes = reference.axes if axes is None else axes
    of_axes = [axis.name for axis in axes]
    arguments = list(inspect.signature(function).parameters)
    coefficients = [each for each in arguments if each not in of_axes]
    own = name or getattr(function, "__name__", "form").replace("_", "-")
    for missing in (each for each in of_axes if each not in arguments):
        raise ValueError(f"{own} does not take {missing!r}: allowed is a function of all axes")
    if len(start) not in (0, len(coefficients)):
        raise ValueError(f"{own}: {len(start)} starts given for {len(coefficients)} coefficients")

    def value(c, *point):
        given = dict(zip(of_axes, point, strict=True))
        return function(**given, **{key: c[k] for k, key in enumerate(coefficients)})

    summary = (inspect.getdoc(function) or own).splitlines()[0]
    starts = (np.array(start, float),) if len(start) else ()
    return Form(own, summary, reference, axes, coefficients, (Stage(value),), starts=starts)


class FittedForm(eqx.Module):
    """A form with its coefficients, which are its only array leaf."""

    form: Form = eqx.field(static=True)
    coefficients: Array | np.ndarray

    def __call__(self, *point) -> Array:
        """Evaluate the form at one point of its axes."""
        return self.form(self.coefficients, *point)

    def first(self, *shared) -> Any:
        """Evaluate the first stage at the axes that it takes."""
        return self.form.first(self.coefficients, *shared)

    @property
    def axes(self) -> tuple[Axis, ...]:
        """The axes of the form."""
        return self.form.axes

    @property
    def reference(self) -> Reference:
        """The exact values that the form stands for."""
        return self.form.reference

    @property
    def constants(self) -> np.ndarray:
        """The coefficients as NumPy numbers, which a trace takes for constants."""
        return np.asarray(self.coefficients, np.float64)


def traced(
    fitted: FittedForm, call: Callable, axes: tuple[Axis, ...], results: int | None = None
) -> Program:
    """Trace a function of a form on some axes: of a scalar, or of a tuple of `results`."""
    parameters = tuple(Parameter(axis.name, (axis.lower, axis.upper)) for axis in axes)
    reference = fitted.reference
    summary = f"{reference.symbol} by {fitted.form.equation}"
    return trace(Function(reference.name, summary, parameters, results, "value", call))
