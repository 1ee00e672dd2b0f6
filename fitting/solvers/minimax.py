"""The least largest error, by a sequence of linear programs.

Each program is that of the form's tangent, within a trust region. Where a form is linear in its
coefficients, the tangent is the form; elsewhere the result is a minimum among its neighbours.
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

# Points, and points with derivatives, that are evaluated at once.
_BATCH, _BATCH_OF_SLOPES = 4096, 512
# Bounded values are kept this far from 0 and 1 at the points.
_ROOM = 1e-3
# An error on the wrong side counts this many times when points and steps are chosen.
_WRONG = 1e5


@dataclass(frozen=True)
class Residuals:
    """The weighted errors that are made small, as functions of the free coefficients (m,).

    `values` gives errors (n,), `slopes` their derivatives (rows, m) at some rows. `positive` and
    `positive_slopes` are the same for what the form keeps positive. `least` and `most` (n,) are
    the lowest and the highest errors that are allowed.
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

    `free` (m,) tells which coefficients are free; the others have their values in `fixed` (m,).
    `bounded` allows no value of the form below 0 or above 1, with some room to either.
    """

    def at(function, z, x, batch):
        whole = fixed.copy()
        whole[free] = z
        return np.asarray(in_batches(functools.partial(function, form, whole), x, batch))

    # No more room than half of what the exact value leaves: it may be 0 or 1.
    low, high = np.minimum(_ROOM, exact / 2), 1 - np.minimum(_ROOM, (1 - exact) / 2)
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
    """Compile a function of a form, coefficients and a point for points: once for a form."""
    return jax.jit(
        lambda form, c, points: jax.vmap(lambda p: function(form, c, p))(points), static_argnums=0
    )


_values, _rooms = _at_points(_value), _at_points(_room)
_slopes, _room_slopes = _at_points(jax.grad(_value, 1)), _at_points(jax.grad(_room, 1))


@dataclass(frozen=True)
class Minimax:
    """The solver of the least largest error, and what tunes it.

    * `programs`: at most so many linear programs.
    * `rows`, `rows_a_coefficient`: each program has the worst points, this many and so many more
      a coefficient.
    * `trust`, `least_trust`: the first step may change a coefficient by this part; the search ends
      when the trust region is smaller than the second.
    * `worthwhile`, `patience`: programs that lower the error by less than this part are idle; the
      search ends after so many idle ones.
    * `over`: a slack on what is not allowed costs this much in a program, so that a start may be
      on the wrong side.
    * `floor`: what must stay positive is kept above this at the points.
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
        """Return coefficients (m,) whose largest error is least.

        `side` is 'both', 'below' (every error ≤ 0 at the points) or 'above'.
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
        """Solve the tangent's program: the step (m,) that makes the largest linear error least."""
        slopes, values = problem.slopes(z, rows), error[rows]
        room = problem.positive(z)
        low = largest_of(-room, self.rows)
        guard = problem.positive_slopes(z, np.nonzero(low)[0])
        spare = room[low] - self.floor
        held = np.any(guard != 0, axis=1)
        guard, spare = guard[held], np.maximum(spare[held], 0.0)
        unit = 1 / np.maximum(np.abs(slopes).max(axis=0), 1e-12)
        radius = trust * np.maximum(np.abs(z), 0.05) / unit
        # t bounds the size of every error. What is not allowed is bounded by a slack s, which costs
        # so much that it is zero wherever it can be. Where a whole side is not allowed, t does not
        # bound it.
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
    """Return the lowest and the highest errors (n,) that the problem and a side allow."""
    return (
        np.maximum(problem.least, 0) if side == "above" else problem.least,
        np.minimum(problem.most, 0) if side == "below" else problem.most,
    )


def badness(error: np.ndarray, least: np.ndarray, most: np.ndarray) -> np.ndarray:
    """Return the size of each error, larger where it is not allowed; ∞ where it is NaN."""
    bad = np.abs(error) + _WRONG * np.maximum(np.maximum(error - most, least - error), 0)
    return np.where(np.isfinite(bad), bad, np.inf)


def largest_of(size: np.ndarray, count: int) -> np.ndarray:
    """Return a mask (n,) of the `count` largest of sizes (n,)."""
    chosen = np.zeros(len(size), bool)
    count = min(count, len(size))
    chosen[np.argpartition(-size, count - 1)[:count]] = True
    return chosen


def _rows(matrix, limit, some, column) -> tuple[np.ndarray, np.ndarray]:
    """Return some rows of matrix·z ≤ limit, the right side raised by the variable of a column."""
    raised = np.zeros((int(some.sum()), 2))
    if column is not None:
        raised[:, column] = -1
    return np.hstack([matrix[some], raised]), limit[some]
