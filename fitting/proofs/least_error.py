"""A lower bound of the largest error that any coefficients of a form can have."""

from collections.abc import Callable

import numpy as np

from fitting.form import FittedForm
from fitting.solvers.linear_programs import orthonormal_steps, quotient_lines
from fitting.solvers.residuals import Residuals, largest_of, residuals

# The bound is tried at these fractions of the largest error that was found, the highest first.
LEVELS = (0.99999, 0.9999, 0.999, 0.995, 0.99, 0.98, 0.95, 0.9, 0.8, 0.5)
# The linear program uses this many points with the largest errors, and about as many evenly chosen.
ROWS = 500
# Between a level that is shown to be impossible and one that is not, so many more are tried.
_HALVINGS = 4


def least_error(
    fitted: FittedForm, points: np.ndarray, exact: np.ndarray, error_of_exact: float = 0.0
) -> float | None:
    """Return a lower bound of the largest error that any coefficients of a form can have.

    `fitted` has the best known coefficients, `points` is (n, axes), and `exact` (n,) holds the
    exact values there, to within `error_of_exact`, which is subtracted from the bound. If the form
    is a quotient N/D of linear functions with D > 0, its error is at most t where
    |N − exact·D| ≤ t·D, which is linear in the coefficients. The dual solution of a linear program
    is a combination of these inequalities that no coefficients satisfy; then t is a lower bound.
    Another form may be contained in such a quotient (`Proofs.quotient`), whose bound is its own.
    Returns None if no bound is found, or if the form is no such quotient.
    """
    form = fitted.form
    if not (form.has_least_error and form.size):
        return None
    if form.proofs.quotient is not None:
        fitted = form.proofs.quotient(fitted)
        form = fitted.form
    problem = residuals(
        form, points, exact, np.ones(len(exact)), np.full(form.size, True), np.zeros(form.size)
    )
    if problem.parts is None:
        return None
    z = fitted.constants.ravel()
    error = problem.values(z)
    attained = float(np.max(np.abs(error)))
    rows = rows_of(points, error)
    higher = LEVELS[0]
    for level in LEVELS if attained > 0 else ():
        if level * attained <= error_of_exact:
            return None
        if _is_refuted(problem, z, error, rows, level):
            best = _raised(level, higher, lambda some: _is_refuted(problem, z, error, rows, some))
            return best * attained - error_of_exact
        higher = level
    return None


def _raised(level: float, higher: float, is_refuted: Callable[[float], bool]) -> float:
    """Return a refuted level between `level`, which is refuted, and `higher`, which is not."""
    for _ in range(_HALVINGS if higher > level else 0):
        middle = (level + higher) / 2
        level, higher = (middle, higher) if is_refuted(middle) else (level, middle)
    return level


def rows_of(points: np.ndarray, error: np.ndarray) -> np.ndarray:
    """Return the indices of points (n, axes) for a linear program: the worst, and even ones.

    A point that occurs several times counts once.
    """
    _, first = np.unique(points, axis=0, return_index=True)
    some = largest_of(np.abs(error[first]), ROWS)
    some[:: max(len(first) // ROWS, 1)] = True
    return np.sort(first[some])


def _is_refuted(problem: Residuals, z, error, rows, level: float) -> bool:
    """Whether no coefficients have errors below `level` times the largest error at points `rows`.

    The program minimises v, where sign·(e + s·δ) − level·(1 + g·δ) ≤ v for both signs, and e are
    the errors divided by the largest one. Multipliers λ ≥ 0 of these rows with the sum 1 show that
    v is at least Σλ·(sign·e − level), less the size of Σλ·(sign·s − level·g) times the size of δ.
    If this is positive, v cannot be 0. The steps δ keep the mean denominator, so that a denominator
    is at most n times the mean, and weighted errors at most n; with the orthonormal steps this
    limits the size of δ to 2n.
    """
    from scipy.optimize import linprog  # noqa: PLC0415  slow to import

    lines = quotient_lines(problem, z, error, rows, 0)
    basis = orthonormal_steps(lines)
    e, count = lines.error / lines.size, basis.shape[1]
    s, g = lines.slopes @ basis / lines.size, lines.growth @ basis
    weight = lines.weight
    matrix = np.concatenate([(sign * s - level * g) * weight[:, None] for sign in (1, -1)])
    limit = np.concatenate([(level - sign * e) * weight for sign in (1, -1)])
    solved = linprog(
        np.append(np.zeros(count), 1.0),
        np.column_stack([matrix, np.full(len(matrix), -1.0)]),
        limit,
        bounds=[(None, None)] * count + [(None, None)],
        options={f"{kind}_feasibility_tolerance": 1e-10 for kind in ("primal", "dual")},
    )
    if not solved.success:
        return False
    multipliers = np.maximum(-solved.ineqlin.marginals, 0.0)
    total = multipliers.sum()
    if not total > 0:
        return False
    multipliers = multipliers / total
    slack = np.linalg.norm(multipliers @ matrix) * 2 * len(rows)
    return bool(-multipliers @ limit - slack > 1e-12)
