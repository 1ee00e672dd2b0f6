"""Coefficients with the least largest error, by a sequence of linear programs.

The errors of a quotient N/D of linear functions are at most t where |N − f·D| ≤ t·D, which is
linear in the coefficients. Each linear program lowers t as far as the denominator of the present
coefficients allows (differential correction: Barrodale, Powell and Roberts 1972). The result is the
global minimum at the points. For a form that is linear in its coefficients, D = 1 and one program
is enough.

For any other form each linear program replaces the form by its tangent at the present coefficients,
and lets them move only within a trust region, where the tangent is close to the form. The result is
a local minimum.

HiGHS solves programs to an absolute tolerance. Errors are therefore divided by the largest one, and
the unknowns are the coordinates of an orthonormal basis of the tangent space, so that all numbers
in a program are of the order of one, however small the errors are and whatever the monomials.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import linprog

from fitting.goal import Side
from fitting.solvers.residuals import Residuals, badness, largest_of, limits

# HiGHS's tolerances, the smallest first. The numbers of a program are of the order of one. HiGHS
# does not solve every program to its smallest tolerance, and not by every method.
_TOLERANCES = (1e-10, 1e-9, 1e-7)
_METHODS = ("highs-ds", "highs-ipm")
# A direction of the tangent space is left out if its singular value is below this part of the
# largest: it does not change the values.
_RANK = 1e-13
# A program may lower a denominator, and what else must stay positive, to this part of itself.
_LOWERED = 0.1
# A program that promises to lower the largest error by less than this part of it shows that the
# coefficients are optimal.
_OPTIMAL = 1e-8


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


@dataclass(frozen=True)
class Minimax:
    """The solver that minimises the largest error, with its tuning constants.

    * `programs`: the most linear programs that are solved.
    * `rows`, `rows_a_coefficient`: at first, a program has the `rows` points with the largest
      errors, and `rows_a_coefficient` more for each coefficient. Later programs keep these points,
      and so may have up to three times as many. For a quotient the first points are evenly chosen.
    * `trust`, `least_trust`: for a form that is no quotient, the first step may change a
      coefficient by the fraction `trust` of its size. This trust region grows after a good step and
      shrinks after a bad one. The search ends when it is smaller than `least_trust`.
    * `worthwhile`, `patience`: a program that lowers the error by less than the fraction
      `worthwhile` counts as idle, and one that does not lower it as half an idle one. The search
      ends after `patience` idle ones.
    * `over`: an error beyond what is allowed costs this many times as much as an allowed one in a
      linear program. It is not forbidden, because the start may have such errors.
    * `corrections`: the most further programs of a step that correct it for curvature.
    """

    programs: int = 100
    rows: int = 300
    rows_a_coefficient: int = 15
    trust: float = 0.3
    least_trust: float = 1e-6
    worthwhile: float = 1e-5
    patience: float = 4
    over: float = 100.0
    corrections: int = 3

    def __call__(self, problem: Residuals, start: np.ndarray, side: Side = "both") -> np.ndarray:
        """Return the coefficients (m,) with the least largest error that were found from `start`.

        `side` is 'both', 'below' (every error ≤ 0 at the points) or 'above' (every error ≥ 0).
        """
        best = np.asarray(start, float)
        allowed = limits(problem, side)
        least = badness(problem.values(best), *allowed).max(initial=0.0)
        if not len(best) or not 0 < least < np.inf:
            return best
        solve = self._by_tangents if problem.parts is None else self._by_correction
        return solve(problem, best, allowed)

    def _by_correction(self, problem: Residuals, start: np.ndarray, allowed) -> np.ndarray:
        """Minimise the largest error of a quotient: globally, at the points.

        The programs have some of the points. Those where their result is worst are added, until the
        result is not worse elsewhere.
        """
        z, best, least, idle = start, start, np.inf, 0.0
        error = problem.values(z)
        count = self.rows + self.rows_a_coefficient * len(z)
        kept = np.zeros(len(error), bool)
        kept[:: max(len(error) // count, 1)] = True
        for _ in range(self.programs):
            size = badness(error, *allowed)
            known = size[kept].max()
            if size.max() < least:
                idle = 0.0 if size.max() < least * (1 - self.worthwhile) else idle + 1
                best, least = z, size.max()
            kept |= largest_of(size, count // 4) & (size > known)
            rows = np.nonzero(kept)[0]
            lines = quotient_lines(problem, z, error, rows, self.rows)
            trial, promised = self._step(lines, z, rows, allowed, self.trust)
            if promised < _OPTIMAL or idle >= self.patience:
                break
            tried, lowered = problem.values(trial), _lowered(problem, z, trial)
            wrong = lowered < _LOWERED / 2
            now = badness(tried, *allowed)
            if np.any(wrong) or problem.positive(trial).min() <= 0:
                added = kept | wrong & largest_of(-lowered, count // 4)
                if np.array_equal(added, kept):
                    break
                kept = added
            elif now[kept].max() < badness(error, *allowed)[kept].max() * (1 - 1e-10):
                z, error = trial, tried
            else:
                break
        return best

    def _by_tangents(self, problem: Residuals, start: np.ndarray, allowed) -> np.ndarray:
        """Minimise the largest error of any form: locally, with a trust region.

        Where the errors at the end of a step are not those of the tangent, a second program has
        the difference added to its errors, so that the step follows the curvature.
        """
        best, trust, idle = start, self.trust, 0.0
        error = problem.values(best)
        least = badness(error, *allowed).max()
        count = self.rows + self.rows_a_coefficient * len(best)
        kept = np.zeros(len(error), bool)
        for _ in range(self.programs):
            kept |= largest_of(badness(error, *allowed), count)
            if kept.sum() > 3 * count:
                kept = largest_of(badness(error, *allowed), count)
            rows = np.nonzero(kept)[0]
            lines = _of_tangent(problem, best, error, rows, self.rows)
            found, value, promised = None, np.inf, 0.0
            for _ in range(1 + self.corrections):
                trial, gain = self._step(lines, best, rows, allowed, trust)
                promised = promised if found else gain
                tried = problem.values(trial)
                good = problem.positive(trial).min() > 0
                size = badness(tried, *allowed).max() if good else np.inf
                if found is None or size < value * (1 - 1e-10):
                    found, value = (trial, tried), size
                else:
                    break
                if not np.isfinite(size) or size <= least * (1 - 0.9 * gain):
                    break
                bent = tried[rows] - lines.slopes @ (trial - best)
                lines = replace(lines, error=bent)
            trial, tried = found or (best, error)
            if promised < _OPTIMAL and trust >= self.trust:
                break
            if value < least * (1 - 1e-10):
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

    def _step(self, lines: Lines, z, rows, allowed, trust) -> tuple[np.ndarray, float]:
        """Return coefficients (m,) that minimise the largest error at points `rows`.

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
        least, most = (each[rows] / size for each in allowed)
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
            _rows(-lines.room @ basis, np.full(len(lines.room), 1 - _LOWERED)),
        ]
        quotient = len(lines.steps) > len(z)
        if quotient:
            # The scale of numerator and denominator, the last of the unknowns, stays positive.
            parts.append(_rows(-basis[-1:], np.array([1 - _LOWERED])))
        else:
            radius = trust * np.maximum(np.abs(z), 0.05)
            parts += [_rows(sign * basis / radius[:, None], 1 + 0 * z) for sign in (1, -1)]
        matrix, limit = (np.concatenate(each) for each in zip(*parts, strict=True))
        solved = solve_program(
            np.concatenate([np.zeros(count), [1.0, self.over]]),
            matrix,
            limit,
            [*[(None, None)] * count, (-1, None), (0, None)],
        )
        if solved is None:
            return z, np.inf
        step = basis @ solved[:-2]
        over = np.maximum(np.maximum(e - most, least - e), 0).max()
        moved = (z + step[:-1]) / (1 + step[-1]) if quotient else z + step
        return moved, -solved[-2] if over == 0 else np.inf


def _of_tangent(problem: Residuals, z, error, rows, count: int) -> Lines:
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
    # Coefficients may differ by many orders: their scale is that of their columns.
    unit = 1 / np.maximum(np.abs(growth[near]).max(axis=0) + np.abs(slopes).max(axis=0), 1e-300)
    steps = unit[:, None] * _across(mean * unit)
    # Where a denominator is small, its row is divided by what it may grow to.
    weight = np.minimum(weight, 1)
    size = np.abs(error[rows]).max()
    return Lines(error[rows], slopes, growth[rows], growth[near], steps, weight[rows], size)


def _across(row: np.ndarray) -> np.ndarray:
    """Return an orthonormal basis (m, m − 1) of what is orthogonal to a row (m,)."""
    return np.linalg.svd(row[None, :])[2][1:].T


def solve_program(cost, matrix, limit, bounds) -> np.ndarray | None:
    """Return the z that minimises cost·z with matrix·z ≤ limit and bounds; None if HiGHS fails."""
    for tolerance in _TOLERANCES:
        options = {f"{kind}_feasibility_tolerance": tolerance for kind in ("primal", "dual")}
        for method in _METHODS:
            solved = linprog(cost, matrix, limit, bounds=bounds, method=method, options=options)
            if solved.success:
                return solved.x
    return None


def _lowered(problem: Residuals, old: np.ndarray, new: np.ndarray) -> np.ndarray:
    """Return new/old denominators (n,) of a quotient; ones for any other form.

    A step is refused if one of them is not positive.
    """
    parts = problem.parts
    if parts is None:
        return np.ones(len(problem.exact))
    return (parts.b0 + parts.b @ new) / (parts.b0 + parts.b @ old)


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
