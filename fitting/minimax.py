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
BOUND_LEVELS = (0.999, 0.99, 0.95, 0.9, 0.8, 0.5)
BOUND_ROWS = 500
INFEASIBLE = 2  # linprog's status
# What is on the wrong side counts this many times in a program, so that a start may be there, and
# this many when points and steps are chosen.
OVER, WRONG = 100.0, 1e5
# What must stay positive is kept above this at the points.
FLOOR = 1e-3


@dataclass(frozen=True)
class Residuals:
    """What is made small: `values` (n,) of coefficients, `slopes` (n, m) at rows; and `positive`.

    `positive` and `positive_slopes` are the same for what must stay above FLOOR.
    """

    values: Callable[[np.ndarray], np.ndarray]
    slopes: Callable[[np.ndarray, np.ndarray], np.ndarray]
    positive: Callable[[np.ndarray], np.ndarray]
    positive_slopes: Callable[[np.ndarray, np.ndarray], np.ndarray]


def residuals(
    form: type[Form], points: np.ndarray, exact: np.ndarray, scale: np.ndarray, fixed: np.ndarray
) -> Residuals:
    """Give the weighted errors of a form's free coefficients; `fixed` (m,) has NaN for those."""
    free = np.isnan(fixed)

    def at(function, z, x, chunk):
        whole = fixed.copy()
        whole[free] = z
        return np.asarray(in_chunks(functools.partial(function, form, whole), x, chunk))

    return Residuals(
        lambda z: (at(_values, z, points, CHUNK) - exact) * scale,
        lambda z, rows: at(_slopes, z, points[rows], CHUNK_OF_ROWS)[:, free] * scale[rows, None],
        lambda z: at(_rooms, z, points, CHUNK),
        lambda z, rows: at(_room_slopes, z, points[rows], CHUNK_OF_ROWS)[:, free],
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
    error = problem.values(best)
    least, trust, idle = badness(error, side).max(), TRUST, 0.0
    count = ROWS + ROWS_A_COEFFICIENT * len(best)
    kept = np.zeros(len(error), bool)
    for _ in range(programs):
        kept |= _worst(badness(error, side), count)
        if kept.sum() > 3 * count:
            kept = _worst(badness(error, side), count)
        rows = np.nonzero(kept)[0]
        step = _program(problem, best, error, rows, side, trust)
        trial = best + step
        tried = problem.values(trial)
        value = badness(tried, side).max() if problem.positive(trial).min() > 0 else np.inf
        if value < least * (1 - 1e-9):
            idle = 0.0 if value < least * (1 - WORTHWHILE) else idle + 1
            best, error, least = trial, tried, value
            trust = min(2 * trust, 3.0)
        else:
            if np.isfinite(tried).all():
                kept |= _worst(badness(tried, side), 50)
            trust, idle = trust / 3, idle + 0.5
        if trust < LEAST_TRUST or idle >= PATIENCE:
            break
    return best


def badness(error: np.ndarray, side: Side) -> np.ndarray:
    """Give the size of each error, larger where it is on the wrong side; ∞ where it is NaN."""
    sign = {"both": 0, "below": 1, "above": -1}[side]
    bad = np.abs(error) + WRONG * np.maximum(sign * error, 0)
    return np.where(np.isfinite(bad), bad, np.inf)


def _worst(size: np.ndarray, count: int) -> np.ndarray:
    chosen = np.zeros(len(size), bool)
    count = min(count, len(size))
    chosen[np.argpartition(-size, count - 1)[:count]] = True
    return chosen


def _program(problem, z, error, rows, side, trust) -> np.ndarray:
    """Solve the tangent's program: the step (m,) that makes the largest linear error least."""
    slopes, values = problem.slopes(z, rows), error[rows]
    room = problem.positive(z)
    low = _worst(-room, ROWS)
    guard, spare = problem.positive_slopes(z, np.nonzero(low)[0]), room[low] - FLOOR
    held = np.any(guard != 0, axis=1)
    guard, spare = guard[held], np.maximum(spare[held], 0.0)
    unit = 1 / np.maximum(np.abs(slopes).max(axis=0), 1e-12)
    radius = trust * np.maximum(np.abs(z), 0.05) / unit
    # One-sided: t bounds the size of the error on one side; on the other, only a slack s does that
    # costs so much that it is zero wherever it can be.
    bounded, slack = np.array([[-1.0, 0.0]]), np.array([[0.0, -1.0]])
    upper = np.repeat(slack if side == "below" else bounded, len(rows), axis=0)
    lower = np.repeat(slack if side == "above" else bounded, len(rows), axis=0)
    matrix = np.concatenate(
        [
            np.hstack([slopes * unit, upper]),
            np.hstack([-slopes * unit, lower]),
            np.hstack([-guard * unit, np.zeros((len(guard), 2))]),
        ]
    )
    limit = np.concatenate([-values, values, spare])
    bounds = [(-r, r) for r in radius] + [(0, None)] * 2
    cost = np.concatenate([np.zeros(len(z)), [1.0, OVER]])
    solved = linprog(cost, matrix, limit, bounds=bounds)
    return solved.x[:-2] * unit if solved.success else np.zeros(len(z))


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
