"""Coefficients with the least largest error, by a sequence of linear programs.

The errors of a quotient N/D of linear functions are at most t where |N − f·D| ≤ t·D, which is
linear in the coefficients. Each linear program lowers t as far as the denominator of the present
coefficients allows (differential correction: Barrodale, Powell and Roberts 1972). The result is the
global minimum at the points. For a form that is linear in its coefficients, D = 1 and one program
is enough.

For any other form each linear program replaces the form by its tangent at the present coefficients,
and lets them move only within a trust region, where the tangent is close to the form. The result is
a local minimum.
"""

from dataclasses import dataclass, replace

import numpy as np

from fitting.goal import Side
from fitting.solvers.linear_programs import LOWERED, best_step, quotient_lines, tangent_lines
from fitting.solvers.residuals import Residuals, badness, largest_of, limits

# A program that promises to lower the largest error by less than this part of it shows that the
# coefficients are optimal.
_OPTIMAL = 1e-8


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
            limit = tuple(each[rows] for each in allowed)
            trial, promised = best_step(lines, z, limit, self.trust, self.over)
            if promised < _OPTIMAL or idle >= self.patience:
                break
            tried, lowered = problem.values(trial), _lowered(problem, z, trial)
            wrong = lowered < LOWERED / 2
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
            lines = tangent_lines(problem, best, error, rows, self.rows)
            limit = tuple(each[rows] for each in allowed)
            found, value, promised = None, np.inf, 0.0
            for _ in range(1 + self.corrections):
                trial, gain = best_step(lines, best, limit, trust, self.over)
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


def _lowered(problem: Residuals, old: np.ndarray, new: np.ndarray) -> np.ndarray:
    """Return new/old denominators (n,) of a quotient; ones for any other form.

    A step is refused if one of them is not positive.
    """
    parts = problem.parts
    if parts is None:
        return np.ones(len(problem.exact))
    return (parts.b0 + parts.b @ new) / (parts.b0 + parts.b @ old)
