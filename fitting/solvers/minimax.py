"""Coefficients with the least largest error, by a sequence of linear programs.

Each linear program replaces the form by its tangent at the present coefficients, and lets them move
only within a trust region, where the tangent is close to the form. A form that is linear in its
coefficients is its own tangent, so that the result is the global minimum. For other forms it is a
local minimum.
"""

import functools
from collections.abc import Callable
from dataclasses import dataclass

import jax
import numpy as np
from jax import Array
from scipy.optimize import linprog

from fitting.form import Form
from fitting.goal import Side
from fitting.linearity import positive_of
from integrals.reference import in_batches

# The number of points at which values are evaluated at once, and at which derivatives are.
_BATCH, _BATCH_OF_SLOPES = 4096, 512
# The values of a bounded fit are kept this far from the ends of the codomain at the points, so that
# they also stay within it elsewhere.
_ROOM = 1e-3
# When points and steps are chosen, the part of an error beyond what is allowed counts this many
# times.
_WRONG = 1e5


@dataclass(frozen=True)
class Residuals:
    """The weighted errors that a fit minimises, as functions of the free coefficients (m,).

    * `values` returns the errors (n,) at all points.
    * `slopes` takes the indices of some points too, and returns the derivatives (rows, m) there.
    * `positive` and `positive_slopes` do the same for the number that must stay positive.
    * `least` and `most` (n,) are the lowest and the highest error that is allowed at each point.
    """

    values: Callable[[np.ndarray], np.ndarray]
    slopes: Callable[[np.ndarray, np.ndarray], np.ndarray]
    positive: Callable[[np.ndarray], np.ndarray]
    positive_slopes: Callable[[np.ndarray, np.ndarray], np.ndarray]
    least: np.ndarray
    most: np.ndarray


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

    `free` is a mask of the free coefficients; the others have their values in `fixed`. Both have an
    element for each coefficient of the form. If `bounded`, values of the form are only allowed
    between 0 and 1, with some distance from both.
    """

    def at(function, z, x, batch):
        whole = fixed.copy()
        whole[free] = z
        return np.asarray(in_batches(functools.partial(function, form, whole), x, batch))

    # The exact value may itself be an end: the distance is at most half of the exact value's own.
    lower, upper = form.reference.codomain
    low = lower + np.minimum(_ROOM, (exact - lower) / 2)
    high = upper - np.minimum(_ROOM, (upper - exact) / 2)
    least, most = (
        (end - exact) * scale if bounded else np.full(len(exact), limit)
        for end, limit in ((low, -np.inf), (high, np.inf))
    )
    return Residuals(
        lambda z: (at(_values, z, points, _BATCH) - exact) * scale,
        lambda z, rows: at(_slopes, z, points[rows], _BATCH_OF_SLOPES)[:, free] * scale[rows, None],
        lambda z: at(_rooms, z, points, _BATCH),
        lambda z, rows: at(_room_slopes, z, points[rows], _BATCH_OF_SLOPES)[:, free],
        least,
        most,
    )


def _value(form: Form, c: Array, point: Array) -> Array:
    return form(c.reshape(form.coefficient_shape), *point)


def _room(form: Form, c: Array, point: Array) -> Array:
    return positive_of(form)(c.reshape(form.coefficient_shape), *point)


def _at_points(function):
    """Map a function of a form, coefficients and a point over points; compiled once for a form."""
    return jax.jit(
        lambda form, c, points: jax.vmap(lambda p: function(form, c, p))(points), static_argnums=0
    )


_values, _rooms = _at_points(_value), _at_points(_room)
_slopes, _room_slopes = _at_points(jax.grad(_value, 1)), _at_points(jax.grad(_room, 1))


@dataclass(frozen=True)
class Minimax:
    """The solver that minimises the largest error, with its tuning constants.

    * `programs`: the most linear programs that are solved.
    * `rows`, `rows_a_coefficient`: at first, a program has the `rows` points with the largest
      errors, and `rows_a_coefficient` more for each coefficient. Later programs keep these points,
      and so may have up to three times as many.
    * `trust`, `least_trust`: the first step may change a coefficient by the fraction `trust` of its
      size. This trust region grows after a good step and shrinks after a bad one. The search ends
      when it is smaller than `least_trust`.
    * `worthwhile`, `patience`: a program that lowers the error by less than the fraction
      `worthwhile` counts as idle, and one that does not lower it as half an idle one. The search
      ends after `patience` idle ones.
    * `over`: an error beyond what is allowed costs this many times as much as an allowed one in a
      linear program. It is not forbidden, because the start may have such errors.
    * `floor`: the number that must stay positive is kept above this at the points.
    """

    programs: int = 30
    rows: int = 300
    rows_a_coefficient: int = 15
    trust: float = 0.3
    least_trust: float = 1e-6
    worthwhile: float = 1e-4
    patience: int = 4
    over: float = 100.0
    floor: float = 1e-3

    def __call__(self, problem: Residuals, start: np.ndarray, side: Side = "both") -> np.ndarray:
        """Return the coefficients (m,) with the least largest error that were found from `start`.

        `side` is 'both', 'below' (every error ≤ 0 at the points) or 'above' (every error ≥ 0).
        """
        best = np.asarray(start, float)
        if not len(best):
            return best
        error, allowed = problem.values(best), limits(problem, side)
        least, trust, idle = badness(error, *allowed).max(), self.trust, 0.0
        count = self.rows + self.rows_a_coefficient * len(best)
        kept = np.zeros(len(error), bool)
        for _ in range(self.programs):
            kept |= largest_of(badness(error, *allowed), count)
            if kept.sum() > 3 * count:
                kept = largest_of(badness(error, *allowed), count)
            rows = np.nonzero(kept)[0]
            trial = best + self._step(problem, best, error, rows, allowed, trust)
            tried = problem.values(trial)
            good = problem.positive(trial).min() > 0
            value = badness(tried, *allowed).max() if good else np.inf
            if value < least * (1 - 1e-9):
                idle = 0.0 if value < least * (1 - self.worthwhile) else idle + 1
                best, error, least = trial, tried, value
                trust = min(2 * trust, 3.0)
            else:
                if np.isfinite(tried).all():
                    kept |= largest_of(badness(tried, *allowed), 50)
                trust, idle = trust / 3, idle + 0.5
            if trust < self.least_trust or idle >= self.patience:
                break
        return best

    def _step(self, problem, z, error, rows, allowed, trust) -> np.ndarray:
        """Return the step (m,) that minimises the largest error of the tangent at points `rows`.

        It is zero if the linear program is not solved.
        """
        slopes, values = problem.slopes(z, rows), error[rows]
        room = problem.positive(z)
        low = largest_of(-room, self.rows)
        guard = problem.positive_slopes(z, np.nonzero(low)[0])
        spare = room[low] - self.floor
        held = np.any(guard != 0, axis=1)
        guard, spare = guard[held], np.maximum(spare[held], 0.0)
        unit = 1 / np.maximum(np.abs(slopes).max(axis=0), 1e-12)
        radius = trust * np.maximum(np.abs(z), 0.05) / unit
        # The program minimises t + over·s. The variable t bounds the size of every allowed error.
        # The slack s bounds by how much errors exceed what is allowed; it costs so much that it is
        # zero if it can be. If no positive error is allowed at a point, only s bounds it there, and
        # so for negative errors.
        least, most = (each[rows] for each in allowed)
        parts = [
            _rows(slopes * unit, -values, most > 0, 0),
            _rows(-slopes * unit, values, least < 0, 0),
            _rows(slopes * unit, most - values, np.isfinite(most), 1),
            _rows(-slopes * unit, values - least, np.isfinite(least), 1),
            _rows(-guard * unit, spare, np.full(len(guard), True), None),
        ]
        matrix, limit = (np.concatenate(each) for each in zip(*parts, strict=True))
        bounds = [(-r, r) for r in radius] + [(0, None)] * 2
        cost = np.concatenate([np.zeros(len(z)), [1.0, self.over]])
        solved = linprog(cost, matrix, limit, bounds=bounds)
        return solved.x[:-2] * unit if solved.success else np.zeros(len(z))


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


def _rows(matrix, limit, some, column) -> tuple[np.ndarray, np.ndarray]:
    """Return the inequalities matrix·z ≤ limit of some rows, for the linear program.

    `column` 0 adds the variable t to the right side, 1 adds s, and None adds nothing.
    """
    raised = np.zeros((int(some.sum()), 2))
    if column is not None:
        raised[:, column] = -1
    return np.hstack([matrix[some], raised]), limit[some]
