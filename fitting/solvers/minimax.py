"""The least largest error, by linear programs: exact where a form is linear in its coefficients.

For a form that is not, each program is that of the form's tangent, within a trust region, and the
result is a minimum among its neighbours. Where a form is a quotient of linear functions, a bound
tells how far from the least of all it may be: whether an error can be had at all is a linear
program (`lower_bound`).
"""

import functools
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import jax
import numpy as np
from jax import Array
from scipy.optimize import linprog

from fitting.errors import in_chunks
from fitting.form import Form

Side = Literal["both", "below", "above"]

# Rows of a program: the worst points, this many and so many more a coefficient.
ROWS, ROWS_A_COEFFICIENT = 300, 15
# Points and rows that are evaluated at once.
CHUNK, CHUNK_OF_ROWS = 4096, 512
TRUST = 0.3
LEAST_TRUST = 1e-6
# Programs that gain less than this part of the error are not followed by many more.
WORTHWHILE = 1e-4
PATIENCE = 4
# A bound is sought at these parts of the error that was found, on this many of the points.
BOUND_LEVELS = (0.999, 0.995, 0.99, 0.98, 0.95, 0.9, 0.8, 0.5)
BOUND_ROWS = 500
INFEASIBLE = 2  # linprog's status
# What is on the wrong side counts this many times in a program, so that a start may be there, and
# this many when points and steps are chosen.
OVER, WRONG = 100.0, 1e5
# Bounded values are kept this far from 0 and 1 at the points.
ROOM = 1e-3
# What must stay positive is kept above this at the points.
FLOOR = 1e-3


@dataclass(frozen=True)
class Residuals:
    """What is made small: `values` (n,) of coefficients, `slopes` (n, m) at rows; and `positive`.

    `positive` and `positive_slopes` are the same for what must stay above FLOOR. `least` and `most`
    (n,) are the lowest and the highest `values` that are allowed.
    """

    values: Callable[[np.ndarray], np.ndarray]
    slopes: Callable[[np.ndarray, np.ndarray], np.ndarray]
    positive: Callable[[np.ndarray], np.ndarray]
    positive_slopes: Callable[[np.ndarray, np.ndarray], np.ndarray]
    least: np.ndarray
    most: np.ndarray


def residuals(
    form: type[Form],
    points: np.ndarray,
    exact: np.ndarray,
    scale: np.ndarray,
    fixed: np.ndarray,
    bounded: bool = False,
) -> Residuals:
    """Give the weighted errors of a form's free coefficients; `fixed` (m,) has NaN for those.

    `bounded` allows no value of the form below 0 or above 1, with some room to either.
    """
    free = np.isnan(fixed)

    def at(function, z, x, chunk):
        whole = fixed.copy()
        whole[free] = z
        return np.asarray(in_chunks(functools.partial(function, form, whole), x, chunk))

    # No more room than half of what the exact value leaves: it may be 0 or 1.
    low, high = np.minimum(ROOM, exact / 2), 1 - np.minimum(ROOM, (1 - exact) / 2)
    least, most = (
        (end - exact) * scale if bounded else np.full(len(exact), limit)
        for end, limit in ((low, -np.inf), (high, np.inf))
    )
    return Residuals(
        lambda z: (at(_values, z, points, CHUNK) - exact) * scale,
        lambda z, rows: at(_slopes, z, points[rows], CHUNK_OF_ROWS)[:, free] * scale[rows, None],
        lambda z: at(_rooms, z, points, CHUNK),
        lambda z, rows: at(_room_slopes, z, points[rows], CHUNK_OF_ROWS)[:, free],
        least,
        most,
    )


def _value(form: type[Form], c: Array, point: Array) -> Array:
    return form(c.reshape(np.shape(form.coefficient_names())))(*point)


def _room(form: type[Form], c: Array, point: Array) -> Array:
    return form(c.reshape(np.shape(form.coefficient_names()))).positive(*point)


def _at_points(function):
    """Compile a function of a form, coefficients and a point for points: once for a form."""
    return jax.jit(
        lambda form, c, points: jax.vmap(lambda p: function(form, c, p))(points), static_argnums=0
    )


_values, _rooms = _at_points(_value), _at_points(_room)
_slopes, _room_slopes = _at_points(jax.grad(_value, 1)), _at_points(jax.grad(_room, 1))


def minimise_largest(
    problem: Residuals, start: np.ndarray, side: Side = "both", programs: int = 30
) -> np.ndarray:
    """Give coefficients (m,) whose largest error is least; `side` 'below' allows none above zero.

    `side` is 'both', 'below' (every error ≤ 0 at the points) or 'above'.
    """
    best = np.asarray(start, float)
    if not len(best):
        return best
    error, allowed = problem.values(best), limits(problem, side)
    least, trust, idle = badness(error, *allowed).max(), TRUST, 0.0
    count = ROWS + ROWS_A_COEFFICIENT * len(best)
    kept = np.zeros(len(error), bool)
    for _ in range(programs):
        kept |= _worst(badness(error, *allowed), count)
        if kept.sum() > 3 * count:
            kept = _worst(badness(error, *allowed), count)
        rows = np.nonzero(kept)[0]
        step = _program(problem, best, error, rows, allowed, trust)
        trial = best + step
        tried = problem.values(trial)
        value = badness(tried, *allowed).max() if problem.positive(trial).min() > 0 else np.inf
        if value < least * (1 - 1e-9):
            idle = 0.0 if value < least * (1 - WORTHWHILE) else idle + 1
            best, error, least = trial, tried, value
            trust = min(2 * trust, 3.0)
        else:
            if np.isfinite(tried).all():
                kept |= _worst(badness(tried, *allowed), 50)
            trust, idle = trust / 3, idle + 0.5
        if trust < LEAST_TRUST or idle >= PATIENCE:
            break
    return best


def limits(problem: Residuals, side: Side) -> tuple[np.ndarray, np.ndarray]:
    """Give the lowest and the highest errors (n,) that are allowed, with those of a side."""
    return (
        np.maximum(problem.least, 0) if side == "above" else problem.least,
        np.minimum(problem.most, 0) if side == "below" else problem.most,
    )


def badness(error: np.ndarray, least: np.ndarray, most: np.ndarray) -> np.ndarray:
    """Give the size of each error, larger where it is not allowed; ∞ where it is NaN."""
    bad = np.abs(error) + WRONG * np.maximum(np.maximum(error - most, least - error), 0)
    return np.where(np.isfinite(bad), bad, np.inf)


def _worst(size: np.ndarray, count: int) -> np.ndarray:
    chosen = np.zeros(len(size), bool)
    count = min(count, len(size))
    chosen[np.argpartition(-size, count - 1)[:count]] = True
    return chosen


def _program(problem, z, error, rows, allowed, trust) -> np.ndarray:
    """Solve the tangent's program: the step (m,) that makes the largest linear error least."""
    slopes, values = problem.slopes(z, rows), error[rows]
    room = problem.positive(z)
    low = _worst(-room, ROWS)
    guard, spare = problem.positive_slopes(z, np.nonzero(low)[0]), room[low] - FLOOR
    held = np.any(guard != 0, axis=1)
    guard, spare = guard[held], np.maximum(spare[held], 0.0)
    unit = 1 / np.maximum(np.abs(slopes).max(axis=0), 1e-12)
    radius = trust * np.maximum(np.abs(z), 0.05) / unit
    # t bounds the size of every error. What is not allowed is bounded by a slack s, which costs so
    # much that it is zero wherever it can be; where that is all of a side, t has nothing to add.
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
    cost = np.concatenate([np.zeros(len(z)), [1.0, OVER]])
    solved = linprog(cost, matrix, limit, bounds=bounds)
    return solved.x[:-2] * unit if solved.success else np.zeros(len(z))


def _rows(matrix, limit, some, column) -> tuple[np.ndarray, np.ndarray]:
    """Give some rows of matrix·z ≤ limit, the right side raised by the variable of a column."""
    raised = np.zeros((int(some.sum()), 2))
    if column is not None:
        raised[:, column] = -1
    return np.hstack([matrix[some], raised]), limit[some]


def lower_bound(
    form: type[Form], points: np.ndarray, exact: np.ndarray, errors: np.ndarray
) -> float | None:
    """Give a largest error that no coefficients of a form go below; None if none is known.

    `errors` (n,) are those of the coefficients that were found.
    For a quotient of linear functions with a positive denominator, |n − f·d| ≤ t·d is linear in the
    coefficients: a t that no coefficients satisfy at some of the points is a bound.
    """
    some = _worst(np.abs(errors), BOUND_ROWS)
    some[:: max(len(points) // BOUND_ROWS, 1)] = True
    parts = linear_parts(form, points[some])
    if parts is None:
        return None
    a0, a, b0, b = parts
    attained = float(np.max(np.abs(errors)))
    for level in BOUND_LEVELS:
        t = level * attained
        rows, limits = [-b], [b0 - 1e-9]
        for sign in (1, -1):
            target = exact[some] + sign * t
            rows.append(sign * (a - target[:, None] * b))
            limits.append(sign * (target * b0 - a0))
        solved = linprog(
            np.zeros(a.shape[1]),
            np.concatenate(rows),
            np.concatenate(limits),
            bounds=[(None, None)] * a.shape[1],
        )
        if solved.status == INFEASIBLE:
            return t
    return None


def linear_parts(form: type[Form], points: np.ndarray) -> tuple[np.ndarray, ...] | None:
    """Give a₀ (n,), a (n, m), b₀ (n,), b (n, m) of a quotient of linear functions, if it is one."""
    if form.linear_parts(*points[0]) is None:
        return None
    parts = jax.jit(jax.vmap(lambda p: form.linear_parts(*p)))(points)
    return tuple(np.asarray(each) for each in parts)
