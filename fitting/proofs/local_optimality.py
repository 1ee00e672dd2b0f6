"""Whether a small change of a form's coefficients would lower its largest error.

A form whose largest error is least, compared with all small changes of its coefficients, meets a
condition: zero is in the convex hull of the gradients of |error| at the points where |error| is
largest. A linear program finds how far a form is from this.
"""

from dataclasses import dataclass

import numpy as np

from fitting.form import FittedForm
from fitting.proofs.least_error import ROWS, rows_of
from fitting.solvers.linear_programs import orthonormal_steps, tangent_lines
from fitting.solvers.residuals import largest_of, limits, residuals

# A multiplier above this belongs to an extremum.
_ACTIVE = 1e-9


@dataclass(frozen=True)
class LocalOptimality:
    """How much a small change of coefficients could lower the largest error, to first order.

    No change that alters the values at the points of the fit by at most the largest error (rms)
    lowers the largest error by more than the fraction `decrease` of it, if the form is replaced by
    its tangent. `extrema` is the number of points that show this.
    """

    decrease: float
    extrema: int


def local_optimality(
    fitted: FittedForm, points: np.ndarray, exact: np.ndarray, bounded: bool = False
) -> LocalOptimality | None:
    """Return how far a form is from the condition for a local minimum of its largest error.

    `points` is (n, axes), `exact` (n,) holds the exact values there. If `bounded`, changes may not
    lead out of the codomain. Multipliers λ ≥ 0 with the sum 1 of the points with large errors show
    it: each is a lower bound Σ λ |error|, less the size of Σ λ·gradient, of what a step can reach.
    More points can only make `decrease` smaller. Returns None for a form without coefficients or
    errors, and if the linear program is not solved.
    """
    from scipy.optimize import linprog  # noqa: PLC0415  slow to import

    form, z = fitted.form, fitted.constants.ravel()
    if not len(z):
        return None
    every = np.full(len(z), True)
    problem = residuals(form, points, exact, np.ones(len(exact)), every, z, bounded)
    error = problem.values(z)
    if not 0 < np.abs(error).max() < np.inf:
        return None
    least, most = limits(problem, "both")
    rows = rows_of(points, error)
    if bounded:
        # The values that are nearest to the ends of the codomain hold steps back too.
        near = largest_of(-np.minimum(most - error, error - least), ROWS)
        rows = np.union1d(rows, np.nonzero(near)[0])
    lines = tangent_lines(problem, z, error, rows, 1)
    slopes = lines.slopes @ orthonormal_steps(lines) / lines.size
    height = lines.error / lines.size
    # What is outside of the codomain may stay there, but may not go farther.
    least, most = (each[rows] / lines.size for each in (least, most))
    above, below = np.maximum(most - height, 0), np.maximum(height - least, 0)
    falls, rises = np.isfinite(above), np.isfinite(below)
    matrix = np.concatenate([slopes, -slopes, slopes[falls], -slopes[rises]])
    limit = np.concatenate([-height, height, above[falls], below[rises]])
    of_size = np.arange(len(matrix)) < 2 * len(rows)
    solved = linprog(
        np.append(np.zeros(slopes.shape[1]), 1.0),
        np.column_stack([matrix, np.where(of_size, -1.0, 0.0)]),
        limit,
        bounds=[(-1, 1)] * slopes.shape[1] + [(None, None)],
        options={f"{kind}_feasibility_tolerance": 1e-10 for kind in ("primal", "dual")},
    )
    if not solved.success:
        return None
    multipliers = np.maximum(-solved.ineqlin.marginals, 0.0)
    total = multipliers[of_size].sum()
    if not total > 0:
        return None
    multipliers = multipliers / total
    reached = -multipliers @ limit - np.abs(multipliers @ matrix).sum()
    return LocalOptimality(
        float(max(1 - reached, 0.0)), int(np.sum(multipliers[of_size] > _ACTIVE))
    )
