"""Values at many points: exact ones with their errors, and those of fitted forms.

These are the public functions. `integrals.many_points` chooses how exact values are computed.
"""

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
    found = [np.zeros(0)]
    for some in _chunks(rows):
        inside = [axis.contains(some[:, k]) for k, axis in enumerate(of.axes)]
        found.append(np.where(np.all(inside, axis=0), form_values(of, some), np.nan))
    return np.concatenate(found).reshape(shape)


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
    found = [estimates_at_many(reference, some) for some in _chunks(rows)]
    value, error = (
        np.concatenate([np.zeros(0), *(np.asarray(getattr(each, name)) for each in found)])
        for name in ("value", "error")
    )
    return Estimate(jnp.asarray(value.reshape(shape)), jnp.asarray(error.reshape(shape)))


def _rows(axes: tuple[Axis, ...], points: np.ndarray) -> tuple[np.ndarray, tuple[int, ...]]:
    """Return points as rows (n, axes), and the shape of their values."""
    array = np.asarray(points, dtype=float)
    if array.ndim == 0 or array.shape[-1] != len(axes):
        names = ", ".join(axis.name for axis in axes)
        raise ValueError(f"points of shape {array.shape}: allowed are (…, {len(axes)}), of {names}")
    return array.reshape(-1, len(axes)), array.shape[:-1]


def _chunks(rows: np.ndarray) -> list[np.ndarray]:
    return [rows[first : first + _CHUNK] for first in range(0, len(rows), _CHUNK)]
