"""`Problem`, the object that holds all about a quantity, and the objects that it consists of."""

import dataclasses
import inspect
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from jax import Array

from fitting.form import FittedForm, Form
from fitting.points.scattered import scattered_points
from fitting.proofs.counterexamples import counterexamples
from fitting.proofs.largest_error import ErrorCode, difference_code
from fitting.proofs.rounding_error import TracedArguments
from fitting.solvers.elsewhere import Counterexamples
from integrals.reference import Axis, Reference, restricted
from programs.functions import Function, Record
from quantities.calling_convention import CallingConvention
from quantities.family import Family
from quantities.plot_hints import PlotHints

# The stated error of a closed form is looked at in 2^_PROBES points and half as many more.
_PROBES = 8


@dataclass(frozen=True)
class ExactCode:
    """A closed form that is exported as shader code, under the name exact/QUANTITY.

    * `axes`: the domain on which the code's error is measured and stated.
    * `functions`: maps a precision ("half", "float" or "double") to the functions, in the order of
      the calls.
    * `arguments_at`: maps points (n, axes) to the arguments (n, …) of each function.
    * `equation`, `remark`: texts for the header of the code.
    * `staged`: the same code as the two functions of a form of two stages. It maps a precision, the
      structure between them, and whether cosines stand for angles, to the functions. None: the
      quantity has no such forms.
    * `left`: a text for the header, which says what error remains in exact arithmetic.
    * `traced`: the same as `arguments_at` for proofs, as a JAX function; None: there are none.
    """

    equation: str
    axes: tuple[Axis, ...]
    functions: Callable[[str], tuple[Function, ...]]
    arguments_at: Callable[[np.ndarray], tuple[np.ndarray, ...]]
    remark: str | None = None
    left: str = "none but the rounding of float64"
    staged: Callable[[str, Record, bool], tuple[Function, ...]] | None = None
    traced: TracedArguments | None = None


@dataclass(frozen=True)
class Average:
    """The exact value as a weighted sum over another quantity, for the report's explorer.

    The explorer runs in a browser and needs a formula. A quantity without a closed form has none,
    but it may be an average of the `integrand`, a quantity that has one. The first axes of the
    integrand are those of the quantity. For each of its other axes `rules` has nodes and weights.
    The weight of a point is the product of its weights.
    """

    integrand: "Problem"
    rules: tuple[tuple[np.ndarray, np.ndarray], ...]


@dataclass(frozen=True)
class Published:
    """Constants in print: the name of the form that they belong to, their values, and the source.

    `coefficients` are in the order of the form's. The source is a citation.
    """

    form: str
    coefficients: Sequence[float | int]
    source: str


@dataclass(eq=False)
class Problem:
    """A quantity: its exact values, the forms that approximate it, and how it is called and drawn.

    * `reference`: the exact values and the axes.
    * `forms`: the forms that belong to no family. `shadefit refit NAME` fits the first one.
      `families`: the families, by name.
    * `calling`: the names, arguments and clamps of the exported functions.
    * `published`: constants in print, which others are compared with. The built-in quantities have
      theirs in files instead.
    * `candidates`: returns the forms that a search tries. Its argument maps the names of axes to
      the lower ends of their domains, such as {"alpha": 0.15}. None: `forms`.
    * `search_lower`: the lower ends that `candidates` takes, with their defaults.
    * `closed_form`: the exact value in float64, as a function of the axes that can be traced; the
      report's explorer evaluates it. `exact_code`: the same for shaders.
    * `error_code`: returns the code with which the largest error of a form is proven, or None if
      there is none for this form. None: the difference from `closed_form`, or from
      the closed form of the reference.
    * `plot`: how the quantity is drawn; None stands for default hints. `average`: for a quantity
      that is an average of another one.
    * `topic`: the folder below `coefficients/tables` that has the tables of the quantity; a user's
      quantity has none.
    * `searches_best`: whether a search begins with the forms of the best tables. This is for a
      quantity whose candidates do not contain all of these.
    """

    reference: Reference
    forms: Sequence[Form]
    calling: CallingConvention
    published: Sequence[Published] = ()
    families: Mapping[str, Family] = field(default_factory=dict)
    candidates: Callable[[Mapping[str, float]], Iterator[Form]] | None = None
    search_lower: Mapping[str, float] = field(default_factory=dict)
    closed_form: Callable[..., Array] | None = None
    error_code: Callable[[FittedForm], ErrorCode | None] | None = None
    exact_code: ExactCode | None = None
    plot: PlotHints | None = None
    average: Average | None = None
    topic: str = ""
    searches_best: bool = False

    @property
    def name(self) -> str:
        """The name of the quantity."""
        return self.reference.name

    @property
    def symbol(self) -> str:
        """The symbol of the quantity."""
        return self.reference.symbol

    @property
    def axes(self) -> tuple[Axis, ...]:
        """The axes of the quantity."""
        return self.reference.axes

    @property
    def description(self) -> str:
        """The symbol and the meaning of the quantity, as one line of text."""
        meaning = self.reference.meaning
        return f"{self.symbol}, {meaning}" if meaning else self.symbol

    @property
    def default(self) -> Form:
        """The form that `shadefit refit NAME` fits. Raises ValueError if there is no form."""
        if not self.forms:
            raise ValueError(f"{self.name} has no form: add one, such as {self.name}.rational(…)")
        return self.forms[0]

    @property
    def single_forms(self) -> dict[str, Form]:
        """The forms that belong to no family, by name; the default one comes first."""
        return {form.name: form for form in self.forms}

    def changed(self, **fields: Any) -> "Problem":
        """Return the same quantity with some fields changed."""
        own = {each.name: getattr(self, each.name) for each in dataclasses.fields(Problem)}
        return Problem(**{**own, **fields})

    def tried(self, lower: Mapping[str, float]) -> Iterator[Form]:
        """Yield the forms that a search tries; `lower` has lower ends of their axes, by name."""
        if self.candidates is not None:
            return self.candidates(lower)
        return (self._raised(form, lower) for form in self.forms)

    def _raised(self, form: Form, lower: Mapping[str, float]) -> Form:
        """Return a form in a smaller domain: with other lower ends of some axes."""
        if not lower:
            return form
        upper = {axis.name: axis.upper for axis in form.axes}
        ends = {name: (value, upper[name]) for name, value in lower.items()}
        return replace(form, axes=restricted(form.axes, **ends))

    def code_of_error(self, fitted: FittedForm) -> ErrorCode | None:
        """Return the code with which the largest error of a form is proven; None without any.

        The exact value is `closed_form`, or else the closed form of the reference. Raises
        ValueError if it consists of other operations than those of a program.
        """
        if self.error_code is not None:
            return self.error_code(fitted)
        exact, leg = self.closed_form, self.reference.closed_form
        if exact is None and leg is not None:
            # Without the check of the domain, which returns NaN outside
            bare = inspect.unwrap(leg)

            def exact(*point):
                return bare(*point).value

        if exact is None:
            return None
        points = scattered_points(self.reference, fitted.axes, _PROBES, _PROBES)
        stated = float(np.max(self.reference.estimates(points).error))
        return difference_code(fitted, exact, stated)

    def counterexamples(self) -> Counterexamples | None:
        """Return a search for points with errors above a level; None without a compiler.

        It finds narrow ridges that a search by points misses, and nothing for a form whose error
        has no code.
        """
        return counterexamples(self.code_of_error)

    def has_form(self, name: str, shape: dict[str, Any] | None) -> bool:
        """Return whether there is a form, or for a shape a family, with this name."""
        return name in (self.single_forms if shape is None else self.families)

    def find_form(self, name: str, shape: dict[str, Any] | None = None) -> Form:
        """Return the form with a name, or the form with a shape from the family with that name.

        `shape` is None for a form that belongs to no family. Raises ValueError for a name that is
        not known, and for a shape that is not allowed.
        """
        if shape is None and name in self.single_forms:
            return self.single_forms[name]
        if name not in self.families:
            allowed = ", ".join((*self.single_forms, *self.families))
            raise ValueError(f"form {name!r} is not known: allowed are {allowed}")
        return self.families[name].form(name, shape or {})
