"""Points inside a domain, on its boundary, and where the quantity is steep, with exact values.

Points on the boundary are needed because the largest error is often there.
"""

import functools

import numpy as np

from fitting.form import Form
from fitting.points.domain import Domain
from fitting.points.grids import sobol_points
from integrals.reference import Axis, Reference, box_of

OFF_GRID_SEED = 20200717
# Scale points about the centre by this and clip: some land on faces.
_STRETCH = 1.25


def scattered_points(
    reference: Reference, axes: tuple[Axis, ...], exponent: int, seed: int
) -> np.ndarray:
    """Return 2^exponent points inside a domain, and half as many more, some of them on its faces.

    The points (n, axes) are distributed along each axis as its `scale` says. The quantity's
    `sampling.extra` adds further points, if it has any.
    """
    lower, upper = box_of(axes).T
    width = upper - lower
    inside = (sobol_points(axes, exponent, seed) - lower) / width
    faces = (sobol_points(axes, exponent - 1, seed + 1) - lower) / width
    unit = np.concatenate([inside, np.clip((faces - 0.5) * _STRETCH + 0.5, 0, 1)])
    points = np.stack([axis.place(unit[:, k]) for k, axis in enumerate(axes)], axis=1)
    extra = reference.sampling.extra
    return points if extra is None else np.concatenate([points, extra(points)])


def judging_points(domain: Form | Domain) -> tuple[np.ndarray, np.ndarray]:
    """Return the points (n, axes) at which a form's rms error is measured, and the exact values.

    The points are uniform in the domain, and no fit uses them. Of data, they are the rows that are
    held out, or if there are none, all rows. The values are (n,).
    """
    if domain.reference.data is not None:
        return data_points(domain, domain.reference.data.judging)[:2]
    return _judging(domain.reference, domain.axes)


def checking_points(domain: Form | Domain, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the scattered points (n, axes) at which large errors are sought, and exact values.

    Of data, they are those of `judging_points`.
    """
    if domain.reference.data is not None:
        return judging_points(domain)
    return _checking(domain.reference, domain.axes, seed)


def data_points(
    domain: Form | Domain, rows: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the points (n, axes) of some rows of the data, their values (n,) and weights (n,).

    Rows outside the domain are left out. Raises ValueError if none is inside.
    """
    data = domain.reference.data
    assert data is not None
    inside = np.all(
        [axis.contains(data.points[rows, k]) for k, axis in enumerate(domain.axes)], axis=0
    )
    rows = rows[inside]
    if not len(rows):
        raise ValueError(f"{data.source} has no row in the domain of the form")
    return data.points[rows], data.values[rows], data.weights(rows)


@functools.lru_cache(maxsize=16)
def _judging(reference: Reference, axes: tuple[Axis, ...]) -> tuple[np.ndarray, np.ndarray]:
    points = sobol_points(axes, reference.sampling.judged, OFF_GRID_SEED)
    return points, reference.values(points)


@functools.lru_cache(maxsize=16)
def _checking(
    reference: Reference, axes: tuple[Axis, ...], seed: int
) -> tuple[np.ndarray, np.ndarray]:
    points = scattered_points(reference, axes, reference.sampling.checked, seed)
    return points, reference.values(points)
