"""How a quantity is drawn: hints for its axes, its values, and the report's explorer."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import isfinite, pi

from integrals.reference import Axis


@dataclass(frozen=True)
class AxisHint:
    """How an axis is drawn.

    Pictures show the axis from `lower` to `upper`. In the report's explorer its slider goes over
    `explored` (None: the same range) and begins at `start`. All four numbers are in the axis's own
    unit. Shown values are multiplied by `factor` and have the unit `unit`, such as 180/π and "°".

    `label` is the text at the axis, without the unit; `short_label` (None: `label`) is used where
    there is little room. Both may contain Matplotlib's mathtext. If `logarithmic`, curves and maps
    have a logarithmic axis.
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
        """Return the hint for an axis that has none: its whole domain, with angles in degrees.

        An infinite end is replaced by a finite one. An end that is not part of the domain is
        replaced by a value near it.
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
        """The label, followed by the unit of the shown values."""
        return f"{self.label} / {self.unit}" if self.unit else self.label


@dataclass(frozen=True)
class HemisphereHint:
    """Two axes that together are a direction. They are drawn as a disc, the hemisphere from above.

    `polar` and `azimuth` are the names of the axes, which are in radians. `caption` is the text
    below the disc.
    """

    polar: str
    azimuth: str
    caption: str


@dataclass(frozen=True)
class PlotHints:
    """How a quantity is drawn.

    * `axes` has a hint for each axis, by name; an axis without one gets `AxisHint.default`.
    * `values` is the range of values that is drawn; None stands for the range of the exact values.
      `value_label` is its label and `exact_label` the legend of the exact values. Both may contain
      mathtext.
    * The colour scale of the explorer's error maps goes from −`largest_error` to `largest_error`.
    * Surfaces are seen from `azimuth`, in degrees, and have `surface_nodes` points an axis. Maps of
      errors have `map_nodes` points an axis.
    * `cost_label` is the label of an axis with the operations of forms.
    * `against` is the name of the axis that the explorer draws curves against at first; None stands
      for the last one.
    * `hemisphere` is for a quantity with a direction among its axes.
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

    def axis(self, axis: Axis) -> AxisHint:
        """Return the hint of an axis, or its default hint if it has none."""
        return self.axes.get(axis.name) or AxisHint.default(axis)
