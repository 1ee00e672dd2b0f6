"""A quantity, as one object: exact values, forms, shader names, and how it is drawn."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from math import isfinite, pi
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
    """How an axis is drawn.

    Pictures show the axis from `lower` to `upper`. In the report's explorer its slider goes over
    `explored` (None: the same range) and begins at `start`. All four numbers are in the axis's own
    unit. Shown values are multiplied by `factor` and have the unit `unit`, such as 180/π and "°".

    `label` is the text at the axis, without the unit; `short_label` (None: `label`) is used where
    there is little room. Both may contain mathtext. `logarithmic` holds for curves and maps.
    """

    label: str
    lower: float
    upper: float
    start: float
    explored: tuple[float, float] | None = None
    short_label: str | None = None
    logarithmic: bool = False
    factor: float = 1.0
    unit: str = ""

    @classmethod
    def default(cls, axis: Axis) -> "AxisHint":
        """Return the hint of an axis without one: its whole domain, angles in degrees.

        An infinite end is replaced by a finite one, and an end that is no part of the domain by a
        value near it.
        """
        lower = axis.lower if isfinite(axis.lower) else min(-1.0, 10 * axis.upper)
        upper = axis.upper if isfinite(axis.upper) else max(1.0, 10 * lower)
        if axis.open_below:
            lower += (upper - lower) / 1000
        angle = axis.unit == "rad"
        return cls(
            axis.symbol,
            lower,
            upper,
            (lower + upper) / 2,
            logarithmic=axis.scale == "logarithmic" and lower > 0,
            factor=180 / pi if angle else 1.0,
            unit="°" if angle else "",
        )

    @property
    def slider(self) -> tuple[float, float]:
        """The range of the slider."""
        return self.explored or (self.lower, self.upper)

    @property
    def shown_label(self) -> str:
        """The label with the unit of the shown values."""
        return f"{self.label} / {self.unit}" if self.unit else self.label


@dataclass(frozen=True)
class HemisphereHint:
    """Two axes that are a direction, and can be drawn as a disc: the hemisphere from above.

    `polar` and `azimuth` name the axes, in radians; `caption` says what the disc shows.
    """

    polar: str
    azimuth: str
    caption: str


@dataclass(frozen=True)
class AverageHint:
    """The exact value as a weighted sum over another quantity, for the report's explorer.

    The explorer needs an expression, which a quantity without closed form does not have. The
    `integrand` has one, and has the same first axes. For each of its further axes `rules` has nodes
    and weights, which are multiplied.
    """

    integrand: "Problem"
    rules: tuple[tuple[np.ndarray, np.ndarray], ...]


@dataclass(frozen=True)
class PlotHints:
    """How a quantity is drawn.

    * `axes` has a hint for each axis, by name; an axis without one gets `AxisHint.default`.
    * `values` is the range of the quantity that is drawn; None stands for that of its exact values.
      `value_label` is its label and `exact_label` the legend of its exact values, with mathtext.
    * The colours of maps end at an error of ±`largest_error`.
    * Surfaces are seen from `azimuth`, in degrees, and have `surface_nodes` points an axis. Maps of
      errors have `map_nodes` points an axis.
    * `cost_label` says what the operations of a form are counted for.
    * `against` names the axis that the explorer first draws curves against (None: the last one).
    * `hemisphere` and `average` are for quantities that have a direction, or are a sum.
    """

    axes: Mapping[str, AxisHint] = field(default_factory=dict)
    values: tuple[float, float] | None = None
    value_label: str | None = None
    exact_label: str = "exact"
    largest_error: float = 0.1
    azimuth: float = -60.0
    surface_nodes: int = 41
    map_nodes: int = 61
    cost_label: str = "operations"
    against: str | None = None
    hemisphere: HemisphereHint | None = None
    average: AverageHint | None = None

    def axis(self, axis: Axis) -> AxisHint:
        """Return the hint of an axis."""
        return self.axes.get(axis.name) or AxisHint.default(axis)


@dataclass(frozen=True, eq=False)
class Problem:
    """A quantity: its exact values, the forms that stand for it, and how it is called and drawn.

    * `reference`: the exact values and the axes.
    * `default`: the form that `refit NAME` fits; `forms`: all forms by name that are no family's.
    * `families`: families of forms by name. `candidates` maps lower ends of axes, such as
      {"alpha": 0.15}, to the forms that a search tries; None stands for `default` and `forms`.
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

    def tried(self, lower: Mapping[str, float]) -> Iterator[Form]:
        """Yield the forms that a search tries: the candidates, or all forms that are no family's."""
        if self.candidates is not None:
            return self.candidates(lower)
        return iter(self.single_forms.values())

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
