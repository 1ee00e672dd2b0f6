"""The weighted errors of a form at scattered points, as functions of its free coefficients."""

import functools
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fitting.form import Form
from fitting.goal import Side
from fitting.linearity import LinearParts, linear_parts
from fitting.points.scattered import scattered_points
from fitting.solvers.at_points import SlopesAt, ValuesAt

# The values of a bounded fit are kept this far from the ends of the codomain at the points, so that
# they also stay within it elsewhere.
_ROOM = 1e-3
# Between data, denominators are kept positive at 2^this many points and half as many on faces.
_BETWEEN, _SEED = 10, 20201128
# When points and steps are chosen, the part of an error beyond what is allowed counts this many
# times.
_WRONG = 1e5


@dataclass(frozen=True)
class Residuals:
    """The weighted errors that a fit minimises, as functions of the free coefficients (m,).

    * `values` returns the errors (n,) at all points.
    * `slopes` takes the indices of some points too, and returns the derivatives (rows, m) there.
    * `positive` and `positive_slopes` do the same for the number that must stay positive. Of data,
      there are further points between the data's own, because the proof is about all of them.
    * `least` and `most` (n,) are the lowest and the highest error that is allowed at each point.
    * `exact` and `scale` (n,) are the exact values and the weights of the errors.
    * `find_parts` returns the form as a quotient of linear functions of the free coefficients; None
      if it is no such quotient. `parts` calls it once.
    """

    values: Callable[[np.ndarray], np.ndarray]
    slopes: Callable[[np.ndarray, np.ndarray], np.ndarray]
    positive: Callable[[np.ndarray], np.ndarray]
    positive_slopes: Callable[[np.ndarray, np.ndarray], np.ndarray]
    least: np.ndarray
    most: np.ndarray
    exact: np.ndarray
    scale: np.ndarray
    find_parts: Callable[[], LinearParts | None] = lambda: None

    @functools.cached_property
    def parts(self) -> LinearParts | None:
        """The form as a quotient of linear functions of the free coefficients, or None."""
        return self.find_parts()

    def is_good(self, z: np.ndarray) -> bool:
        """Whether all errors are finite, and what must stay positive is so at all points."""
        return bool(np.isfinite(self.values(z)).all() and self.positive(z).min(initial=1) > 0)


def residuals(
    form: Form,
    points: np.ndarray,
    exact: np.ndarray,
    scale: np.ndarray,
    free: np.ndarray,
    fixed: np.ndarray,
    bounded: bool = False,
) -> Residuals:
    """Return the weighted errors of a form as functions of its free coefficients.

    `points` are (n, axes), the `exact` values and their `scale` (n,). `free` is a mask of the free
    coefficients; the others have their values in `fixed`. Both have an element for each
    coefficient. If `bounded`, values of the form are only allowed between the ends of the codomain,
    with some distance from both.
    """

    def whole(z):
        c = fixed.copy()
        c[free] = z
        return c

    all_free, unweighted = bool(free.all()), bool(np.all(scale == 1))

    def chosen(columns):
        return columns if all_free else columns[:, free]

    def weighted(columns, rows):
        return columns if unweighted else columns * scale[rows, None]

    # The exact value may itself be an end: the distance is at most half of the exact value's own.
    lower, upper = form.reference.codomain
    low = lower + np.minimum(_ROOM, (exact - lower) / 2)
    high = upper - np.minimum(_ROOM, (upper - exact) / 2)
    least, most = (
        (end - exact) * scale if bounded else np.full(len(exact), limit)
        for end, limit in ((low, -np.inf), (high, np.inf))
    )
    guarded = points
    if form.reference.data is not None:
        between = scattered_points(form.reference, form.axes, _BETWEEN, _SEED)
        guarded = np.concatenate([points, between])
    at, slopes = ValuesAt(form, points), SlopesAt(form, points)
    at_guarded = at if guarded is points else ValuesAt(form, guarded)
    room_slopes = slopes if guarded is points else SlopesAt(form, guarded)
    return Residuals(
        lambda z: (at.values(whole(z)) - exact) * scale,
        lambda z, rows: weighted(chosen(slopes.values(whole(z), rows)), rows),
        lambda z: at_guarded.rooms(whole(z)),
        lambda z, rows: chosen(room_slopes.rooms(whole(z), rows)),
        least,
        most,
        exact,
        scale,
        lambda: _free_parts(form, points, free, fixed),
    )


def _free_parts(form: Form, points, free, fixed) -> LinearParts | None:
    """Return the linear parts for the free coefficients, with the others' values put in."""
    parts = linear_parts(form, points)
    if parts is None or free.all():
        return parts
    held = np.where(free, 0.0, fixed)
    return LinearParts(
        parts.a0 + parts.a @ held, parts.a[:, free], parts.b0 + parts.b @ held, parts.b[:, free]
    )


def limits(problem: Residuals, side: Side) -> tuple[np.ndarray, np.ndarray]:
    """Return the lowest and the highest error (n,) that both the problem and the side allow."""
    return (
        np.maximum(problem.least, 0) if side == "above" else problem.least,
        np.minimum(problem.most, 0) if side == "below" else problem.most,
    )


def badness(error: np.ndarray, least: np.ndarray, most: np.ndarray) -> np.ndarray:
    """Return the size of each error (n,), much larger if it is not allowed; ∞ for NaN."""
    bad = np.abs(error) + _WRONG * np.maximum(np.maximum(error - most, least - error), 0)
    return np.where(np.isfinite(bad), bad, np.inf)


def largest_of(size: np.ndarray, count: int) -> np.ndarray:
    """Return a mask (n,) of the `count` largest of sizes (n,)."""
    chosen = np.zeros(len(size), bool)
    count = min(count, len(size))
    chosen[np.argpartition(-size, count - 1)[:count]] = True
    return chosen
