"""Forms: compact functions with coefficients that approximate a quantity."""

import inspect
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jax import Array

from integrals.reference import Axis, Reference
from integrals.user_functions import label
from programs.functions import Function, Parameter
from programs.program import Program
from programs.tracing.tracer import trace


@dataclass(frozen=True)
class Stage:
    """One of the one or two steps in which a form is evaluated.

    The first stage is called with the coefficients and the values of its axes. A second stage is
    called with the results of the first, and with its own arguments, which `Form.inputs` computes.
    `summary` is a line for the comments of exported code that describes the stage. In that code the
    array of a first stage's results is called `result_name`, and the clamped arguments of a second
    stage have the names `arguments`; None leaves the choice to the printer. `limited` is the same
    function with limits of denominators and radicands that change no value on the domain. Exported
    code has them, so that it is finite elsewhere and in half precision; fits and proofs do not.
    """

    call: Callable[..., Any]
    summary: str = ""
    result_name: str = "c"
    arguments: tuple[str, ...] | None = None
    limited: Callable[..., Any] | None = None

    @property
    def exported(self) -> Callable[..., Any]:
        """The function that is exported: with limits if the stage has them."""
        return self.call if self.limited is None else self.limited


def unguarded(*_) -> Array:
    """Return 1. As `Proofs.positive` it leaves a fit free: only the certificate excludes poles."""
    return jnp.ones(())


@dataclass(frozen=True)
class Proofs:
    """Functions that proofs and fits use instead of the form, because they are easier to bound.

    `value` and `margins` take the coefficients and a point of `axes`, by default the form's axes.
    `positive` takes the coefficients and a point of the form's axes.

    * `value`: the form without the lower limits that protect its denominators from rounding, since
      with them a proof would not see whether a denominator vanishes. None: the form itself.
    * `margins`: returns a tuple. If none of its elements is negative anywhere, all values of the
      form are in [0, 1]. None: the values are bounded directly.
    * `positive`: returns a number that a fit keeps positive. None: the least of the divisors,
      radicands and arguments of logarithms in the form's traced program.
    * `below`: takes the fitted form. If the number that it returns is positive, no value of the
      form is above the exact one. None: there is no such proof.
    * `inputs`: maps a point of `axes` to the arguments of the second stage. None: `Form.inputs`.
    * `quotient`: takes the fitted form, and returns one with the same values that is a quotient of
      linear functions of its coefficients, and whose form contains this one. A lower bound of its
      largest error is one of this form's. None: there is no such form, or it is this one.
    * `first_split`: the number of pieces into which branch and bound divides the first axes before
      it begins.
    """

    axes: tuple[Axis, ...] | None = None
    value: Callable[..., Array] | None = None
    margins: Callable[..., tuple[Array, ...]] | None = None
    positive: Callable[..., Array] | None = None
    below: Callable[["FittedForm"], float] | None = None
    inputs: Callable[..., tuple[Array, ...]] | None = None
    quotient: Callable[["FittedForm"], "FittedForm"] | None = None
    first_split: tuple[int, ...] = ()


@dataclass(frozen=True, eq=False)
class Wider:
    """A form that has another one as the special case in which some coefficients are fixed.

    Fits evaluate it in place of the other one, so that one compiled program serves all its special
    cases, and is made for speed (fitting/solvers/at_points.py). Its values must be the same, with
    their derivatives: a fixed coefficient is a zero or a one whose term or factor changes nothing.
    For a form that is fitted they are the same to the last digit. The numbers that must stay
    positive must be the same too.

    * `form`: the wider form. `fixed`: its flat coefficients; those at `places` do not count.
    * `places`: where the flat coefficients of the other form are among them.
    """

    form: "Form"
    places: tuple[int, ...]
    fixed: tuple[float, ...]

    def coefficients(self, c: np.ndarray) -> np.ndarray:
        """Return the flat coefficients of the wider form for those of the other one."""
        whole = np.array(self.fixed)
        whole[list(self.places)] = c
        return whole


@dataclass(frozen=True, eq=False)
class Form:
    """A function that approximates a quantity, with coefficients that have no values yet.

    * `reference`: the exact values. `axes`: the axes of the quantity, restricted to the domain that
      the form is fitted on.
    * `equation`: the formula, see `fitting/equation.py`.
    * `coefficient_names`: a list, or a nested list, which has the shape of the coefficients.
    * `stages`: one; or two, if many points share a large part of the work. Then the first stage
      takes the first `shared` axes, and `inputs` maps the values of all axes to the arguments of
      the second stage.
    * `starts`: coefficients that a fit may start from. None of them is from a published table.
    * `shape`: the arguments that make this form in its family; None for a form of no family.
    * `solver`: fits the form on a grid (`fitting/solvers`); None stands for the general `OnGrid`.
    * `scattered_solver`: fits the form to scattered points; None stands for the general `Exchange`.
    * `wider`: a form that is evaluated in place of this one, see `Wider`; None if there is none.
    * `printed`: where the equation is printed, such as 'Eq. (3)'; empty if nowhere.
    * `has_least_error`: whether to look for a lower bound of the largest error. There is one only
      for a form that is a quotient of linear functions of its coefficients.
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
    scattered_solver: Any = None
    has_least_error: bool = True
    printed: str = ""
    wider: Wider | None = None

    @property
    def coefficient_shape(self) -> tuple[int, ...]:
        """The shape of the coefficients."""
        return np.shape(self.coefficient_names)

    @property
    def size(self) -> int:
        """The number of coefficients."""
        return int(np.size(self.coefficient_names))

    def __call__(self, coefficients: Array | np.ndarray, *point) -> Array:
        """Evaluate the form at one point: a scalar for each axis, in the axis's unit."""
        if self.inputs is None:
            return self.stages[0].call(coefficients, *point)
        inputs = self.inputs(*point)
        return self.stages[1].call(self.first(coefficients, *point[: self.shared]), *inputs)

    def first(self, coefficients: Array | np.ndarray, *shared) -> Any:
        """Evaluate the first stage at values of the axes that it takes."""
        return self.stages[0].call(coefficients, *shared)

    def fitted(self, coefficients: Array | np.ndarray) -> "FittedForm":
        """Return the form with these coefficients, given in their shape or as a flat array."""
        if np.size(coefficients) == self.size and not isinstance(coefficients, Array):
            # JAX would compile a program that reshapes.
            coefficients = np.reshape(coefficients, self.coefficient_shape)
        return FittedForm(self, jnp.asarray(coefficients).reshape(self.coefficient_shape))


def plain_form(
    function: Callable[..., Any],
    reference: Reference,
    start: Sequence[float | int] = (),
    name: str | None = None,
    axes: tuple[Axis, ...] | None = None,
    sizes: Mapping[str, int] | None = None,
) -> Form:
    """Make a form of a plain function of scalars.

    The function's arguments that are named like axes are the axes; all others are coefficients. The
    first line of the function's docstring is the equation.

    Arguments: `start`, coefficients that a fit may start from, which a quotient of linear functions
    of its coefficients does not need; `name`, by default the function's; `axes`, the axes of the
    reference restricted to the form's domain, by default not restricted; `sizes`, the lengths of
    the arguments that are arrays of coefficients, by name. Raises ValueError for a function that
    does not take every axis, for arguments without a name (`*c`), and for a start of the wrong
    length.
    """
    axes = reference.axes if axes is None else axes
    sizes = sizes or {}
    of_axes = [axis.name for axis in axes]
    coefficients = _coefficients_of(function, of_axes, sizes)
    own = name or getattr(function, "__name__", "form").strip("<>").replace("_", "-")
    names = [
        text
        for each in coefficients
        for text in ([f"{each}{k}" for k in range(sizes[each])] if each in sizes else [each])
    ]
    if len(start) not in (0, len(names)):
        raise ValueError(
            f"{label(function)}: {len(start)} starts given for {len(names)} coefficients"
        )

    def value(c, *point):
        given, first = dict(zip(of_axes, point, strict=True)), 0
        for each in coefficients:
            size = sizes.get(each)
            given[each] = c[first] if size is None else c[first : first + size]
            first += size or 1
        return jnp.asarray(function(**given))

    summary = (inspect.getdoc(function) or own).splitlines()[0]
    starts = (np.array(start, float),) if len(start) else ()
    return Form(own, summary, reference, axes, names, (Stage(value),), starts=starts)


def _coefficients_of(
    function: Callable[..., Any], axes: Sequence[str], sizes: Mapping[str, int]
) -> list[str]:
    """Return the arguments of a function that are coefficients."""
    parameters = inspect.signature(function).parameters
    allowed = f"allowed are the axes {', '.join(axes)}, and then coefficients"
    for each in parameters.values():
        if each.kind in (each.VAR_POSITIONAL, each.VAR_KEYWORD, each.POSITIONAL_ONLY):
            raise ValueError(f"{label(function)}: {each} has no name to call it by: {allowed}")
    for missing in (each for each in axes if each not in parameters):
        first = next(iter(parameters), None)
        if first is not None and first not in axes:
            raise ValueError(f"{label(function)} begins with {first}: {allowed}")
        raise ValueError(f"{label(function)} does not take {missing}: {allowed}")
    found = [each for each in parameters if each not in axes]
    for each, size in sizes.items():
        if each not in found or size < 1:
            raise ValueError(f"{label(function)}: sizes of {each} = {size}: {allowed}")
    return found


class FittedForm(eqx.Module):
    """A form with the values of its coefficients, which are the only part that JAX traces."""

    form: Form = eqx.field(static=True)
    coefficients: Array | np.ndarray

    def __call__(self, *point) -> Array:
        """Evaluate the form at one point of its axes."""
        return self.form(self.coefficients, *point)

    def first(self, *shared) -> Any:
        """Evaluate the first stage at values of the axes that it takes."""
        return self.form.first(self.coefficients, *shared)

    @property
    def axes(self) -> tuple[Axis, ...]:
        """The axes of the form."""
        return self.form.axes

    @property
    def reference(self) -> Reference:
        """The exact values that the form approximates."""
        return self.form.reference

    @property
    def constants(self) -> np.ndarray:
        """The coefficients as a NumPy array, which a traced program holds as constants."""
        return np.asarray(self.coefficients, np.float64)


def traced(
    fitted: FittedForm, call: Callable, axes: tuple[Axis, ...], results: int | None = None
) -> Program:
    """Trace `call`, a function of a fitted form, as a program whose inputs are `axes`.

    `results` is the length of the tuple that `call` returns; None if it returns a scalar. The
    program is for proofs: it keeps steps that may be undefined.
    """
    parameters = tuple(Parameter(axis.name, (axis.lower, axis.upper)) for axis in axes)
    reference = fitted.reference
    summary = f"{reference.symbol} by {fitted.form.equation}"
    function = Function("form", summary, parameters, results, "value", call)
    return trace(function, keep_undefined=True)
