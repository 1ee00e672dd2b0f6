"""Values at many points: exact ones with their errors, and those of fitted forms.

These are the public functions. `integrals.many_points` chooses how exact values are computed.
"""

from collections.abc import Iterator

import jax.numpy as jnp
import numpy as np

from fitting.errors import form_values
from fitting.form import FittedForm
from integrals.many_points import estimates_at_many
from integrals.reference import Axis, Estimate, Reference
from quantities.problem import Problem

# So many points are evaluated at once, so that memory does not grow with their number.
_CHUNK = 1 << 18


def values(of: Problem | Reference | FittedForm, points: np.ndarray) -> np.ndarray:
    """Return the values of a quantity or of a fitted form at many points.

    `points` (…, axes) has the arguments in the order of the axes, angles in radians. Returns the
    values (…) in float64; NaN outside the domain. The exact values of a quantity are those of its
    most exact leg; `estimates` returns their errors too. Raises ValueError for points with another
    number of arguments, and for a quantity whose exact values are not known.
    """
    if not isinstance(of, FittedForm):
        return np.asarray(estimates(of, points).value)
    rows, shape = _rows(of.axes, points)
    found = np.empty(len(rows))
    for part in _parts(rows):
        inside = [axis.contains(rows[part, k]) for k, axis in enumerate(of.axes)]
        found[part] = np.where(np.all(inside, axis=0), form_values(of, rows[part]), np.nan)
    return found.reshape(shape)


def estimates(of: Problem | Reference, points: np.ndarray) -> Estimate:
    """Return the exact values of a quantity at many points, and their errors.

    As `values`, for a quantity or its reference: value and error are (…) each. An integral without
    a closed form, such as R, is fastest on grids: points that share all arguments but one are
    evaluated together.
    """
    reference = of.reference if isinstance(of, Problem) else of
    rows, shape = _rows(reference.axes, points)
    if not reference.legs:
        reference.best_leg  # noqa: B018  It says why there are no exact values.
    value, error = np.empty(len(rows)), np.empty(len(rows))
    for part in _parts(rows):
        found = estimates_at_many(reference, rows[part])
        value[part], error[part] = found.value, found.error
    return Estimate(jnp.asarray(value.reshape(shape)), jnp.asarray(error.reshape(shape)))


def _rows(axes: tuple[Axis, ...], points: np.ndarray) -> tuple[np.ndarray, tuple[int, ...]]:
    """Return points as rows (n, axes), and the shape of their values."""
    if np.iscomplexobj(points):
        raise ValueError("complex points: allowed are real numbers")
    array = np.asarray(points, dtype=float)
    if array.ndim == 0 or array.shape[-1] != len(axes):
        names = ", ".join(axis.name for axis in axes)
        raise ValueError(f"points of shape {array.shape}: allowed are (…, {len(axes)}), of {names}")
    return array.reshape(-1, len(axes)), array.shape[:-1]


def _parts(rows: np.ndarray) -> Iterator[slice]:
    return (slice(first, first + _CHUNK) for first in range(0, len(rows), _CHUNK))
