"""A lower bound of the largest error that any coefficients of a form can have."""

import numpy as np
from scipy.optimize import linprog

from fitting.form import Form
from fitting.linearity import linear_parts
from fitting.solvers.residuals import largest_of

# The bound is tried at these fractions of the largest error that was found, the highest first.
LEVELS = (0.999, 0.995, 0.99, 0.98, 0.95, 0.9, 0.8, 0.5)
# The linear program uses this many points with the largest errors, and about as many evenly chosen.
ROWS = 500
_INFEASIBLE = 2  # linprog's status


def least_error(
    form: Form, points: np.ndarray, exact: np.ndarray, errors: np.ndarray
) -> float | None:
    """Return a lower bound of the largest error that any coefficients of a form can have.

    `errors` (n,) are those of the fit, at `points` (n, axes) with the exact values `exact` (n,). If
    the form is a quotient N/D of linear functions with D > 0, its error is at most t where
    |N − exact·D| ≤ t·D, which is linear in the coefficients. If a linear program shows that no
    coefficients satisfy this at some of the points, t is a lower bound. Returns None if no bound is
    found, or if the form is no such quotient.
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
