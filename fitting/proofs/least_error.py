"""A largest error that no coefficients of a form go below."""

import numpy as np
from scipy.optimize import linprog

from fitting.form import Form
from fitting.linearity import linear_parts
from fitting.solvers.minimax import largest_of

# The bound is sought at these parts of the error that was found, on this many of the points.
LEVELS = (0.999, 0.995, 0.99, 0.98, 0.95, 0.9, 0.8, 0.5)
ROWS = 500
_INFEASIBLE = 2  # linprog's status


def least_error(
    form: Form, points: np.ndarray, exact: np.ndarray, errors: np.ndarray
) -> float | None:
    """Return a lower bound of the largest error of a form for any coefficients; None: unknown.

    `errors` (n,) are those of the coefficients that were found, at `points` (n, axes) with values
    `exact` (n,). For a quotient N/D of linear functions with D > 0, |N − f·D| ≤ t·D is linear in
    the coefficients: a t that no coefficients satisfy at some of the points is a bound.
    """
    if not (form.has_least_error and form.size):
        return None
    some = largest_of(np.abs(errors), ROWS)
    some[:: max(len(points) // ROWS, 1)] = True
    parts = linear_parts(form, points[some])
    if parts is None:
        return None
    attained = float(np.max(np.abs(errors)))
    for level in LEVELS:
        t = level * attained
        rows, limits = [-parts.b], [parts.b0 - 1e-9]
        for sign in (1, -1):
            target = exact[some] + sign * t
            rows.append(sign * (parts.a - target[:, None] * parts.b))
            limits.append(sign * (target * parts.b0 - parts.a0))
        solved = linprog(
            np.zeros(parts.a.shape[1]),
            np.concatenate(rows),
            np.concatenate(limits),
            bounds=[(None, None)] * parts.a.shape[1],
        )
        if solved.status == _INFEASIBLE:
            return t
    return None
