"""Least squares at scattered points: from several starts, inside the domain without poles.

The sum of squared errors is minimised as it is. A penalty for denominators that are not positive is
added only if a descent without it ends with such denominators, because it would bias the result.
"""

from dataclasses import dataclass

import numpy as np

from fitting.solvers.descent import Descent, descend
from fitting.solvers.residuals import Residuals

# If no descent converges, starts near the given ones are tried: so many for each, whose
# coefficients are multiplied by e to a normally distributed number with this deviation.
_NEAR, _SPREAD = 3, 0.3
_SEED = 20110917
# The penalty applies where the number that must stay positive is below this part of its mean size.
_FLOOR = 1e-2
# An end without the penalty is kept only if nothing is below this part of the mean.
_ROOM = 1e-3
# A descent that ends at a larger `worthwhile` is only the start of another method.
_ROUGH = 1e-12


@dataclass(frozen=True)
class SquaresFit:
    """The best end of all descents.

    * `z` (m,): the coefficients. `tried`: the number of starts.
    * `converged`: whether the end is stationary: no small step lowers the sum of squares.
    """

    z: np.ndarray
    converged: bool
    tried: int

    @property
    def words(self) -> str:
        """What to say of a descent that did not converge; empty if it did."""
        if self.converged:
            return ""
        starts = "its start" if self.tried == 1 else f"any of {self.tried} starts"
        return f"least squares did not converge from {starts}: other starts or a simpler form may"


def fit_squares(
    problem: Residuals,
    starts: list[np.ndarray],
    steps: int = 1000,
    worthwhile: float = 1e-15,
    near: int = _NEAR,
) -> SquaresFit | None:
    """Minimise the sum of squared errors from each start (m,); None if every end has a pole.

    * `steps`: the most steps of a descent. `worthwhile`: a descent ends if a step promises to lower
      the sum of squares by less than this fraction.
    * `near`: if no start leads to a stationary point, so many starts near each are tried too.
    """
    if not len(problem.exact) or not starts[0].size:
        return SquaresFit(starts[0], True, 1) if problem.is_good(starts[0]) else None
    ends = [_descend(problem, z, steps, worthwhile) for z in starts]
    if not any(end and end.converged for end in ends):
        random = np.random.default_rng(_SEED)
        for start in starts:
            for _ in range(near if np.isfinite(start).all() else 0):
                z = start * np.exp(_SPREAD * random.normal(size=len(start)))
                ends.append(_descend(problem, z, steps, worthwhile))
    good = [end for end in ends if end is not None]
    if not good:
        return None
    best = min(good, key=lambda end: end.norm)
    return SquaresFit(best.z, best.converged, len(ends))


def _descend(
    problem: Residuals, start: np.ndarray, steps: int, worthwhile: float
) -> Descent | None:
    """Return the end of a descent from one start; None if it has a pole."""
    everywhere = np.arange(len(problem.exact))
    tried = last_refused = 0

    def guarded(z: np.ndarray) -> np.ndarray:
        nonlocal tried, last_refused
        tried += 1
        error = problem.values(z)
        if problem.positive(z).min() > 0:
            return error
        last_refused = tried
        return np.full_like(error, np.inf)

    def slopes(z: np.ndarray) -> np.ndarray:
        return problem.slopes(z, everywhere)

    def from_start(residual, jacobian, z) -> Descent:
        return descend(residual, jacobian, z, steps, worthwhile)

    ends = []
    if problem.is_good(start):
        ends.append(from_start(guarded, slopes, start))
        # If nothing was refused, a descent without the guard would be the same. If only points of
        # its first half were, it would end in about the same place.
        early = worthwhile > _ROUGH and last_refused < tried / 2 and _has_room(problem, ends[0].z)
        if ends[0].converged or not last_refused or early:
            return ends[0]
    ends.append(from_start(problem.values, slopes, start))
    if not problem.is_good(ends[-1].z):
        ends[-1] = _with_penalty(problem, start, from_start, guarded, slopes)
    good = [end for end in ends if problem.is_good(end.z)]
    # An end that is not stationary may be on the verge of a pole.
    safe = [end for end in good if end.converged or _has_room(problem, end.z)]
    # A stationary point is preferred, unless it is worse.
    return min(safe or good, key=lambda end: (end.norm, not end.converged)) if good else None


def _has_room(problem: Residuals, z: np.ndarray) -> bool:
    """Whether what must stay positive is not much less than its mean anywhere."""
    room = problem.positive(z)
    return bool(room.min(initial=1) >= _ROOM * room.mean())


def _with_penalty(problem: Residuals, start, from_start, guarded, slopes) -> Descent:
    """Descend with a penalty on denominators that are not positive, and then without it."""
    room = problem.positive(start)
    size = np.mean(np.abs(room[np.isfinite(room)])) if np.isfinite(room).any() else 1.0
    floor, root = _FLOOR * (size or 1.0), np.sqrt(len(room))
    # A denominator that is zero costs as much as an error of this size everywhere.
    weight = np.sqrt(np.mean((problem.scale * problem.exact) ** 2)) / floor / root
    everywhere = np.arange(len(room))

    def penalised(z: np.ndarray) -> np.ndarray:
        short = np.maximum(floor - problem.positive(z), 0)
        return np.concatenate([problem.values(z), weight * short])

    def both_slopes(z: np.ndarray) -> np.ndarray:
        active = (problem.positive(z) < floor)[:, None]
        penalty = -weight * np.where(active, problem.positive_slopes(z, everywhere), 0.0)
        return np.concatenate([slopes(z), penalty])

    end = from_start(penalised, both_slopes, start)
    if not problem.is_good(end.z):
        return end
    free = from_start(guarded, slopes, end.z)
    return free if free.converged or _has_room(problem, free.z) else end
