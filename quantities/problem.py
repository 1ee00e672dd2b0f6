"""A quantity, as one object: exact values, forms, shader names, and how it is drawn."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from jax import Array

from fitting.form import Form
from integrals.reference import Axis, Reference
from programs.functions import Function
from quantities.calling_convention import CallingConvention
from quantities.family import Family


@dataclass(frozen=True)
class ExactCode:
    """A closed form that is exported as shader code, under the name exact/QUANTITY.

    `functions` maps a precision ("half", "float", "double") to the functions, in the order of their
    calls; `arguments_at` maps points (n, axes) to what they are called with. `axes` are the domain
    whose errors are stated, `equation` and `remark` are written into the header, and so is `left`:
    what error the code has in exact arithmetic.
    """

    equation: str
    axes: tuple[Axis, ...]
    functions: Callable[[str], tuple[Function, ...]]
    arguments_at: Callable[[np.ndarray], tuple[np.ndarray, ...]]
    remark: str | None = None
    left: str = "none but the rounding of float64"


@dataclass(frozen=True)
class AxisHint:
    """How an axis is drawn: its label, the range shown, and where a slider begins.

    Values are multiplied by `factor` to be shown, such as 180/π for degrees.
    """

    label: str
    lower: float
    upper: float
    start: float
    logarithmic: bool = False
    factor: float = 1.0


@dataclass(frozen=True)
class PlotHints:
    """How a quantity is drawn.

    `axes` has a hint for each axis, by name. Errors beyond ±`largest_error` are drawn as if they
    were that. `cost_label` says what the operations of a form are counted for.
    """

    axes: Mapping[str, AxisHint]
    largest_error: float = 0.1
    cost_label: str = "operations"


@dataclass(frozen=True, eq=False)
class Problem:
    """A quantity: its exact values, the forms that stand for it, and how it is called and drawn.

    * `reference`: the exact values and the axes.
    * `default`: the form that `refit NAME` fits; `forms`: all forms by name that are no family's.
    * `families`: families of forms by name; `candidates` maps lower ends of axes, such as
      {"alpha": 0.15}, to the forms that a search tries.
    * `calling`: names, arguments and clamps of the exported functions.
    * `closed_form`: the exact value as a function of the axes that can be exported, in float64;
      `exact_code`: the same as shader code, where it is of use there.
    * `topic`: the folder of the packaged tables. `searches_best`: a search begins with the forms of
      the best tables, because not all of them are among the candidates.
    """

    reference: Reference
    default: Form
    calling: CallingConvention
    forms: tuple[Form, ...] = ()
    families: Mapping[str, Family] = field(default_factory=dict)
    candidates: Callable[[Mapping[str, float]], Iterator[Form]] | None = None
    closed_form: Callable[..., Array] | None = None
    exact_code: ExactCode | None = None
    codomain: tuple[float, float] = (0.0, 1.0)
    plot: PlotHints | None = None
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
        """The symbol and the meaning of the quantity, in one line."""
        return f"{self.symbol}, {self.reference.meaning}"

    @property
    def single_forms(self) -> dict[str, Form]:
        """The forms that are no family's, by name, the default one first."""
        return {form.name: form for form in (self.default, *self.forms)}

    def form(self, name: str, shape: dict[str, Any] | None) -> Form:
        """Return a form by name, and by shape if it is a family's.

        Raises ValueError for a form that is not known, and for a shape that is not allowed.
        """
        if shape is None and name in self.single_forms:
            return self.single_forms[name]
        if name not in self.families:
            allowed = ", ".join((*self.single_forms, *self.families))
            raise ValueError(f"form {name!r} is not known: allowed are {allowed}")
        return self.families[name].form(name, shape or {})
