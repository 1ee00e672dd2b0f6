"""Starts of a fit, for a form that is a quotient of linear functions of its coefficients.

Monomials may differ in size by many orders, and be nearly dependent. All unknowns are therefore
coordinates of a basis that is orthonormal at the points.
"""

import numpy as np

from fitting.linearity import LinearParts
from fitting.solvers.linear_programs import solve_program
from fitting.solvers.residuals import Residuals

# The denominator of a start by a linear program is at least this part of its mean.
_LEAST_DENOMINATOR = 1 / 20
# The linear program has about this many of the points, evenly chosen.
_ROWS = 600
# The number of linear fits of `_linearised`.
_LINEARISED = 8


def quotient_starts(problem: Residuals) -> list[np.ndarray]:
    """Return coefficients (m,) with positive denominators at the points, from three methods.

    * The errors times the denominator, divided by the denominator of the fit before, are minimised
      by least squares, several times.
    * The largest of the errors times the denominator is minimised by a linear program, in which the
      denominator is at least a twentieth of its mean. The coefficients are then not large.
    * The denominator has the coefficients zero, and the numerator is fitted.

    A form that is linear in its coefficients has one start, its least squares fit. The list is
    empty if no method succeeds.
    """
    parts = problem.parts
    if parts is None:
        return []
    if not np.any(parts.b):
        return [_scaled_solution(problem, parts.a, problem.exact * parts.b0 - parts.a0, parts.b0)]
    found = [_linearised(problem, parts), _programmed(problem, parts), _numerator(problem, parts)]
    return [z for z in found if z is not None and np.min(parts.b0 + parts.b @ z) > 0]


def _scaled_solution(problem: Residuals, matrix, values, denominator) -> np.ndarray:
    """Solve matrix·z ≈ values, weighted by scale/denominator, with columns of norm one."""
    factor = problem.scale / denominator
    weighted = matrix * factor[:, None]
    norms = np.linalg.norm(weighted, axis=0)
    unit = 1 / np.where(norms > 0, norms, 1.0)
    return np.linalg.lstsq(weighted * unit, values * factor, rcond=1e-15)[0] * unit


def _linearised(problem: Residuals, parts: LinearParts) -> np.ndarray | None:
    """Return the last of the linear fits with positive denominators; None if the first has none."""
    denominator, found = parts.b0, None
    if not np.all(denominator > 0):
        denominator = np.ones(len(denominator))
    for _ in range(_LINEARISED):
        matrix = parts.a - problem.exact[:, None] * parts.b
        z = _scaled_solution(problem, matrix, problem.exact * parts.b0 - parts.a0, denominator)
        denominator = parts.b0 + parts.b @ z
        if not denominator.min() > 0:
            break
        found = z
    return found


def _programmed(problem: Residuals, parts: LinearParts) -> np.ndarray | None:
    """Return the solution of the linear program, whose unknowns are z·s and s > 0.

    The scale s of numerator and denominator is free, so that the mean denominator can be one. None
    if the best s is zero.
    """
    some = slice(None, None, max(len(problem.exact) // _ROWS, 1))
    below = np.column_stack([parts.b, parts.b0])[some]
    above = np.column_stack([parts.a, parts.a0])[some]
    error = problem.scale[some, None] * (above - problem.exact[some, None] * below)
    both = np.concatenate([error, below])
    unit = 1 / np.maximum(np.linalg.norm(both, axis=0), 1e-300)
    _, singular, right = np.linalg.svd(np.linalg.qr(both * unit, mode="r"))
    basis = unit[:, None] * (right.T / np.maximum(singular, 1e-13 * singular[0]))
    basis = basis * np.sqrt(len(both))
    e, d = error @ basis, below @ basis
    mean = d.mean(axis=0)
    # e ≤ t, −e ≤ t, d ≥ 1/20 of a mean of 1 (which two rows set), and s ≥ 0.
    column = np.concatenate([np.full(2 * len(e), -1.0), np.zeros(len(d) + 3)])
    rows = np.concatenate([e, -e, -d, [mean], [-mean], -basis[-1:] / np.abs(basis[-1]).max()])
    limit = np.concatenate([
        np.zeros(2 * len(e)), np.full(len(d), -_LEAST_DENOMINATOR), [1.0, -1.0, 0.0]
    ])  # fmt: skip
    count = basis.shape[1]
    solved = solve_program(
        np.append(np.zeros(count), 1.0),
        np.column_stack([rows, column]),
        limit,
        [(None, None)] * count + [(0, None)],
    )
    if solved is None:
        return None
    unknowns = basis @ solved[:-1]
    return unknowns[:-1] / unknowns[-1] if unknowns[-1] > 0 else None


def _numerator(problem: Residuals, parts: LinearParts) -> np.ndarray | None:
    """Fit the coefficients of the numerator alone; those of the denominator are zero."""
    if not np.all(parts.b0 > 0):
        return None
    free = ~np.any(parts.b != 0, axis=0)
    z = np.zeros(len(free))
    if free.any():
        values = problem.exact * parts.b0 - parts.a0
        z[free] = _scaled_solution(problem, parts.a[:, free], values, parts.b0)
    return z
