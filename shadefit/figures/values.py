"""What is drawn of a quantity: its hints, and exact and exported values on grids of points."""

import numpy as np

from coefficients.catalogue import published, refitted
from coefficients.exported_code import exported_values
from integrals.reference import Axis, Reference
from quantities import Problem
from quantities.problem import AxisHint, PlotHints


def hints_of(owner: Problem) -> PlotHints:
    """Return how a quantity is drawn; without hints of its own, by defaults from its axes."""
    return owner.plot or PlotHints()


def axis_hints(owner: Problem) -> list[tuple[Axis, AxisHint]]:
    """Return each axis of a quantity with its hint."""
    hints = hints_of(owner)
    return [(axis, hints.axis(axis)) for axis in owner.axes]


def points_along(hint: AxisHint, count: int, *, logarithmic: bool = False) -> np.ndarray:
    """Return `count` values along the range of an axis that pictures show, even or logarithmic."""
    space = np.geomspace if logarithmic else np.linspace
    return space(hint.lower, hint.upper, count)


def mesh(*axes: np.ndarray) -> np.ndarray:
    """Return the points (…, axes) of a tensor grid: its shape has the length of each axis."""
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)


def exact(reference: Reference, points: np.ndarray) -> np.ndarray:
    """Evaluate the exact values at points (…, axes): (…)."""
    return reference.values(points.reshape(-1, points.shape[-1])).reshape(points.shape[:-1])


def compared_values(owner: Problem, points: np.ndarray) -> dict[str, np.ndarray]:
    """Evaluate the exact values, and the published and refitted table as far as they are kept.

    Tables are evaluated by their exported functions, with the clamps. Returns values (…) at points
    (…, axes), by label.
    """
    values = {"exact": exact(owner.reference, points)}
    for label, entry in (("published", published(owner)), ("refitted", refitted(owner))):
        if entry is not None:
            values[label] = exported_values(entry, points)
    return values
