"""Linear programs that lower the largest error of a form from given coefficients.

HiGHS solves programs to an absolute tolerance. Errors are therefore divided by the largest one, and
the unknowns are the coordinates of an orthonormal basis of the tangent space, so that all numbers
in a program are of the order of one, however small the errors are and whatever the monomials.
"""

from dataclasses import dataclass

import numpy as np

from fitting.solvers.residuals import Residuals, largest_of

# HiGHS's tolerances, the smallest first. The numbers of a program are of the order of one. HiGHS
# does not solve every program to its smallest tolerance, and not by every method.
_TOLERANCES = (1e-10, 1e-9, 1e-7)
_METHODS = ("highs-ds", "highs-ipm")
# A direction of the tangent space is left out if its singular value is below this part of the
# largest: it does not change the values.
_RANK = 1e-13
# A program may lower a denominator, and what else must stay positive, to this part of itself.
LOWERED = 0.1


@dataclass(frozen=True)
class Lines:
    """The rows of a linear program at the present coefficients.

    At a step δ, the errors of a quotient are (error + slopes·δ)/(1 + growth·δ), exactly. For any
    other form growth is zero, and the errors are those of the tangent. What must stay positive is
    multiplied by 1 + room·δ, at points of its own. The step is sought in the columns of `steps`.
    `weight` (at most 1) multiplies the rows of errors whose slopes are large. `size` is the largest
    error, by which the program divides.
    """

    error: np.ndarray
    slopes: np.ndarray
    growth: np.ndarray
    room: np.ndarray
    steps: np.ndarray
    weight: np.ndarray
    size: float


def tangent_lines(problem: Residuals, z, error, rows, count: int) -> Lines:
    """Linearise the errors, and what must stay positive at the `count` points with the least."""
    room = problem.positive(z)
    low = np.nonzero(largest_of(-room, count))[0]
    slopes = problem.positive_slopes(z, low)
    held = np.any(slopes != 0, axis=1)
    return Lines(
        error[rows],
        problem.slopes(z, rows),
        np.zeros((len(rows), len(z))),
        slopes[held] / np.maximum(room[low][held], 1e-300)[:, None],
        np.eye(len(z)),
        np.ones(len(rows)),
        np.abs(error[rows]).max(),
    )


def quotient_lines(problem: Residuals, z, error, rows, count: int) -> Lines:
    """Return the rows for a quotient (a₀s + a·c)/(b₀s + b·c), whose unknowns are c and s.

    The present s is 1. Numerator and denominator may be multiplied by any number: the steps keep
    the mean of the denominators.
    """
    parts = problem.parts
    assert parts is not None
    below = parts.b0 + parts.b @ z
    growth = np.column_stack([parts.b, parts.b0]) / below[:, None]
    above = np.column_stack([parts.a, parts.a0])[rows] / below[rows, None]
    slopes = problem.scale[rows, None] * (above - problem.exact[rows, None] * growth[rows])
    near = largest_of(-np.abs(below), count)
    near[rows] = True
    weight = np.abs(below) / np.mean(np.abs(below[near]))
    mean = np.mean(weight[near, None] * growth[near], axis=0)
    # Coefficients may differ by many orders: their scale is that of their columns. A coefficient
    # that changes none of these rows, such as a value of a piecewise form, has none.
    scale = np.abs(growth[near]).max(axis=0) + np.abs(slopes).max(axis=0)
    unit = 1 / np.where(scale > 0, scale, 1.0)
    steps = unit[:, None] * _across(mean * unit)
    # Where a denominator is small, its row is divided by what it may grow to.
    weight = np.minimum(weight, 1)
    size = np.abs(error[rows]).max()
    return Lines(error[rows], slopes, growth[rows], growth[near], steps, weight[rows], size)


def _across(row: np.ndarray) -> np.ndarray:
    """Return an orthonormal basis (m, m − 1) of what is orthogonal to a row (m,)."""
    return np.linalg.svd(row[None, :])[2][1:].T


def best_step(lines: Lines, z, allowed, trust: float, over: float) -> tuple[np.ndarray, float]:
    """Return the coefficients (m,) that minimise the largest error of a program's rows.

    `z` (m,) are the present ones; `allowed` holds the least and the greatest allowed error of each
    row; `over` is the cost of the part of an error beyond that. The step of a form that is no
    quotient may change a coefficient by the fraction `trust` of its size.

    The second result is the part of the largest error that the program takes away; ∞ if the
    program also lowers errors that are not allowed, or is not solved. If it is not solved, the
    coefficients are `z`.
    """
    size = lines.size
    basis = orthonormal_steps(lines)
    count = basis.shape[1]
    if not count:
        return z, 0.0
    e, s, g = lines.error / size, lines.slopes @ basis / size, lines.growth @ basis
    least, most = (each / size for each in allowed)
    # The program minimises t + over·s. The variable t bounds what is gained of every allowed
    # error. The slack s bounds by how much errors exceed what is allowed; it costs so much that
    # it is zero if it can be. If no positive error is allowed at a point, only s bounds it
    # there, and so for negative errors.
    high, low = (np.where(np.isfinite(each), each, 0.0)[:, None] for each in (most, least))
    parts = [
        _rows(s - g, 1 - e, most > 0, 0, lines.weight),
        _rows(-s - g, 1 + e, least < 0, 0, lines.weight),
        _rows(s - high * g, most - e, np.isfinite(most), 1, lines.weight),
        _rows(low * g - s, e - least, np.isfinite(least), 1, lines.weight),
        _rows(-lines.room @ basis, np.full(len(lines.room), 1 - LOWERED)),
    ]
    quotient = len(lines.steps) > len(z)
    if quotient:
        # The scale of numerator and denominator, the last of the unknowns, stays positive.
        parts.append(_rows(-basis[-1:], np.array([1 - LOWERED])))
    else:
        radius = trust * np.maximum(np.abs(z), 0.05)
        parts += [_rows(sign * basis / radius[:, None], 1 + 0 * z) for sign in (1, -1)]
    matrix, limit = (np.concatenate(each) for each in zip(*parts, strict=True))
    solved = solve_program(
        np.concatenate([np.zeros(count), [1.0, over]]),
        matrix,
        limit,
        [*[(None, None)] * count, (-1, None), (0, None)],
    )
    if solved is None:
        return z, np.inf
    step = basis @ solved[:-2]
    wrong = np.maximum(np.maximum(e - most, least - e), 0).max()
    moved = (z + step[:-1]) / (1 + step[-1]) if quotient else z + step
    return moved, -solved[-2] if wrong == 0 else np.inf


def orthonormal_steps(lines: Lines) -> np.ndarray:
    """Return steps (m, r) of which each changes the errors by their largest one, independently.

    The rms change over the rows, times their weights, is `lines.size`.
    """
    slopes = lines.weight[:, None] * (lines.slopes @ lines.steps)
    norms = np.linalg.norm(slopes, axis=0)
    unit = 1 / np.where(norms > 0, norms, 1.0)
    _, singular, right = np.linalg.svd(np.linalg.qr(slopes * unit, mode="r"))
    kept = singular > _RANK * max(singular[0], 1e-300)
    steps = unit[:, None] * right[: len(singular)][kept].T / singular[kept]
    return lines.steps @ steps * (np.sqrt(len(slopes)) * lines.size)


def _rows(matrix, limit, some=None, column=None, weight=None) -> tuple[np.ndarray, np.ndarray]:
    """Return the inequalities matrix·z ≤ limit of some rows, or all, for the linear program.

    `column` 0 adds the variable t to the right side, 1 adds s, and None adds nothing. `weight`
    multiplies the rows.
    """
    some = np.full(len(matrix), True) if some is None else some
    raised = np.zeros((len(matrix), 2))
    if column is not None:
        raised[:, column] = -1
    factor = np.ones(len(matrix)) if weight is None else weight
    return (np.hstack([matrix, raised]) * factor[:, None])[some], (limit * factor)[some]


def solve_program(cost, matrix, limit, bounds) -> np.ndarray | None:
    """Return the z (n,) that minimises cost·z with matrix·z ≤ limit; None if HiGHS fails.

    `cost` (n,), `matrix` (m, n) and `limit` (m,) may be any sequences. `bounds` has a pair for each
    z, or one for all, in which None stands for no bound.
    """
    from scipy.optimize import linprog  # noqa: PLC0415  slow to import

    for tolerance in _TOLERANCES:
        options = {f"{kind}_feasibility_tolerance": tolerance for kind in ("primal", "dual")}
        for method in _METHODS:
            solved = linprog(cost, matrix, limit, bounds=bounds, method=method, options=options)
            if solved.success:
                return solved.x
    return None
