"""How a quantity is called in a shader: names, order of arguments, clamps, and remarks.

The exported functions evaluate the form that was fitted. This module only adds the names, domains
and clamps of the arguments. The coefficients become constants, which the printer writes into the
code.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Literal

import jax
import jax.numpy as jnp
import numpy as np
from jax.ad_checkpoint import checkpoint_name

from fitting.form import FittedForm, Form
from fitting.proofs.rounding_error import TracedArguments
from integrals.reference import Axis
from programs.functions import Function, Parameter, Record, function

# The argument of a second function that holds the results of the first.
MATERIAL = "material"
# The range of a first stage's results is found on a grid of this many nodes an axis.
_SAMPLED = 33

Points = np.ndarray


@dataclass(frozen=True)
class Argument:
    """One argument of an exported function.

    * `axis`: the name of the form's axis that the argument stands for.
    * `name`: the name of the argument in the shader.
    * `clamp`: the ends of the form's domain at which the value is clamped.
    * `least`: the number that a value is clamped to from below, if that is not the lower end of the
      domain. The code may be called with values between the two, but nothing is stated for them.
    * `cosine`: for an angle, the name of the argument that holds its cosine, if the code takes
      cosines.
    * `local`: the name of the variable in the code that holds the clamped value; None leaves the
      choice to the printer.
    """

    axis: str
    name: str
    clamp: Literal["both", "above", "none"] = "none"
    local: str | None = None
    least: float | None = None
    cosine: str | None = None


@dataclass(frozen=True)
class CallingConvention:
    """How the exported functions of a quantity are called.

    A form of one stage is exported as one function. A form of two stages is exported as two: the
    first, Calc…Coeffs, returns results that are arguments of the second, which returns the value.

    * `name`: the name of the function that returns the value.
    * `summary`, `remark`: texts for comments. '{equation}' in the summary stands for ' (Eq. 3)', or
      nothing.
    * `arguments`: the arguments of the only function, or of the first of two.
    * `second`: the names and domains of the second function's arguments after those results. They
      are clamped to their domains.
    * `codomain`: the interval that values are clamped to. None: they are not clamped, because no
      arguments, rounding included, lead out of the codomain.
    * `material`: the name of a structure that can stand for the results of the first function.
    * `cosines`: whether arguments that are angles are replaced by their cosines.
    * `record`: the structure that the first of two functions, …Material, returns and the second
      takes, if the code has that interface. None: it has the interface of the paper's listings.
    * `columns`: maps points (n, axes) of the form to these arguments (n, …), in NumPy.
    """

    name: str
    summary: str
    arguments: tuple[Argument, ...]
    remark: str | None = None
    second: tuple[tuple[str, tuple[float, float]], ...] = ()
    columns: Callable[[Points], Points] | None = None
    codomain: tuple[float, float] | None = None
    material: str | None = None
    cosines: bool = False
    record: Record | None = None

    def functions(self, fitted: FittedForm) -> tuple[Function, ...]:
        """Return the functions that a fitted form is exported as, in the order of the calls."""
        if fitted.form.inputs is None:
            return (self._only(fitted),)
        return self._first(fitted), self._second(fitted)

    def arguments_at(self, fitted: FittedForm, points: Points) -> tuple[Points, ...]:
        """Return the arguments of each function at points (n, axes), as an array (n, …).

        The results of the first function, which the second takes before these, are left out.
        """
        order = [self._place(fitted, argument) for argument in self.arguments]
        first = points[:, order]
        first = self.with_cosines(first)
        if fitted.form.inputs is None:
            return (first,)
        assert self.columns is not None
        return first, self.columns(points)

    def traced_arguments(self, fitted: FittedForm) -> TracedArguments:
        """Return the same as a JAX function, with angles, of the variables of the form's proofs."""
        form = fitted.form
        order = [self._place(fitted, argument) for argument in self.arguments]
        if form.inputs is None:
            return TracedArguments(
                form.axes, lambda *point: tuple(point[k] for k in order), (False,) * len(order)
            )
        inputs = form.proofs.inputs or form.inputs

        def call(*point):
            return (*(point[k] for k in order), *inputs(*point))

        rounded = (*(False for _ in order), *(True for _ in self.second))
        axes = form.axes if form.proofs.inputs is None else form.proofs.axes or form.axes
        return TracedArguments(axes, call, rounded)

    def with_cosines(self, columns: Points) -> Points:
        """Replace angles among the arguments (n, …) by their cosines, if the code takes these."""
        if not self.cosines:
            return columns
        angles = [argument.cosine is not None for argument in self.arguments]
        return np.where(angles, np.cos(columns), columns)

    def _only(self, fitted: FittedForm) -> Function:
        form, constants = fitted.form, fitted.constants

        def value(*given):
            return self._limited(form(jnp.asarray(constants), *self._point(fitted, given)))

        summary = _summary(self.summary, fitted)
        return function(self.name, self._parameters(fitted), value, summary)

    def _first(self, fitted: FittedForm) -> Function:
        form, constants = fitted.form, fitted.constants
        count = _result_count(fitted)

        def results(*given):
            exported = form.stages[0].exported
            return tuple(exported(jnp.asarray(constants), *self._clamped(fitted, given)))

        summary = form.stages[0].summary.format(name=self.name)
        name, result_name, record = f"Calc{self.name}Coeffs", form.stages[0].result_name, None
        if self.record is not None:
            name, result_name = f"{self.name}Material", MATERIAL
            record = self._record(form)
        return function(
            name, self._parameters(fitted), results, summary, count, result_name, record
        )

    def _second(self, fitted: FittedForm) -> Function:
        stage, largest = fitted.form.stages[1], _largest_result(fitted)
        call = stage.exported

        def value(results, *inputs):
            return self._limited(call(results, *self._directed(inputs, stage.arguments)))

        name = fitted.form.stages[0].result_name if self.record is None else MATERIAL
        record, size = self._record(fitted.form), _result_count(fitted)
        parameters = (
            Parameter(name, (-largest, largest), size=size, record=record),
            *(Parameter(name, domain) for name, domain in self.second),
        )
        return function(self.name, parameters, value, fitted.form.stages[1].summary)

    def _record(self, form: Form) -> Record | None:
        """Return the structure, whose members are called as the results are in the equation."""
        if self.record is None:
            return None
        return replace(self.record, member=form.stages[0].result_name)

    def _directed(self, inputs: tuple[Any, ...], names: tuple[str, ...] | None) -> list[Any]:
        """Clamp the second function's own arguments to their domains, under the names of a form."""
        called = names or [name for name, _ in self.second]
        return [
            _called(clamped(value, *ends), name)
            for value, (_, ends), name in zip(inputs, self.second, called, strict=True)
        ]

    def _limited(self, result: Any) -> Any:
        """Clamp a result to the codomain, if the convention has one."""
        return result if self.codomain is None else clamped(result, *self.codomain)

    def _place(self, fitted: FittedForm, argument: Argument) -> int:
        return [axis.name for axis in fitted.axes].index(argument.axis)

    def _axes(self, fitted: FittedForm) -> list[Axis]:
        return [fitted.axes[self._place(fitted, argument)] for argument in self.arguments]

    def _parameters(self, fitted: FittedForm) -> tuple[Parameter, ...]:
        pairs = zip(self.arguments, self._axes(fitted), strict=True)
        return tuple(
            Parameter(argument.cosine, _cosines(axis))
            if self.cosines and argument.cosine is not None
            else Parameter(argument.name, (float(axis.lower), float(axis.upper)), axis.unit)
            for argument, axis in pairs
        )

    def _point(self, fitted: FittedForm, given: tuple[Any, ...]) -> list[Any]:
        """Clamp arguments, and bring them into the order of the form's axes."""
        order = [self._place(fitted, argument) for argument in self.arguments]
        # The value is not assigned to a variable: its name would appear in the exported code.
        return [
            value
            for _, value in sorted(
                zip(order, self._clamped(fitted, given), strict=True), key=lambda pair: pair[0]
            )
        ]

    def _clamped(self, fitted: FittedForm, given: tuple[Any, ...]) -> list[Any]:
        """Clamp arguments to the form's domain; the last argument comes first in the code."""
        values = list(given)
        for k in reversed(range(len(values))):
            # The value is not assigned to a variable: its name would appear in the exported code.
            values[k] = _inside(values[k], self.arguments[k], self._axes(fitted)[k], self.cosines)
        return values


def _inside(value: Any, argument: Argument, axis: Axis, cosines: bool) -> Any:
    """Clamp one argument. If the convention has a name for the result, the code uses it."""
    if cosines and argument.cosine is not None:
        return jnp.arccos(_called(clamped(value, *_cosines(axis)), argument.cosine))
    if argument.clamp == "none":
        return value
    if argument.clamp == "both":
        lower = float(axis.lower) if argument.least is None else argument.least
        return _called(clamped(value, lower, float(axis.upper)), argument.local)
    return _called(jnp.minimum(value, float(axis.upper)), argument.local)


def _cosines(axis: Axis) -> tuple[float, float]:
    """Return the domain of the cosine of an angle in [0, π]."""
    # cos(π/2) is 0 but for the rounding of π.
    least, largest = (round(float(np.cos(end)), 15) for end in (axis.upper, axis.lower))
    return least, largest


def clamped(value: Any, lower: float, upper: float) -> Any:
    """Clamp a traced value to [lower, upper].

    Where minima and maxima are comparisons, or return the number if the other argument is NaN, as
    in C and HLSL, NaN becomes one of the ends.
    """
    return jnp.maximum(jnp.minimum(value, upper), lower)


def _called(value: Any, name: str | None) -> Any:
    return value if name is None else checkpoint_name(value, name)


def renamed(functions: tuple[Function, ...], name: str) -> tuple[Function, ...]:
    """Rename the last function, which returns the value, to `name`, and a first one accordingly."""
    *before, last = functions
    changed = [
        replace(
            each,
            name=f"{name}Material" if each.record is not None else f"Calc{name}Coeffs",
            summary=each.summary.replace(last.name, name),
        )
        for each in before
    ]
    return (*changed, replace(last, name=name))


def _summary(text: str, fitted: FittedForm) -> str:
    """Write a form's equation, such as 'Eq. 3', into a summary.

    The equation of a form of a family is long, and is in the header: here it is left out.
    """
    form = fitted.form
    if form.shape is not None:
        return text.replace(" ({equation})", "").format(equation=form.name)
    printed = form.printed or form.equation
    numbered = re.fullmatch(r"Eq\. \((\d+)\)", printed)
    return text.format(equation=f"Eq. {numbered[1]}" if numbered else printed)


def _result_count(fitted: FittedForm) -> int:
    lower = [axis.lower for axis in fitted.axes[: fitted.form.shared]]
    return len(jax.eval_shape(fitted.first, *lower))


def _largest_result(fitted: FittedForm) -> float:
    """Return the largest absolute value of the first stage's results on a grid of its axes."""
    lines = [np.linspace(a.lower, a.upper, _SAMPLED) for a in fitted.axes[: fitted.form.shared]]
    nodes = [each.ravel() for each in np.meshgrid(*lines)]
    sampled = jax.jit(jax.vmap(lambda *shared: jnp.stack(tuple(fitted.first(*shared)))))
    return float(np.max(np.abs(sampled(*nodes))))
