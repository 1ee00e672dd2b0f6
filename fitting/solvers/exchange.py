"""Fits to scattered points: least squares from several starts, exchange, and rounding.

1. Least squares: the best result of several starts is kept.
2. If the goal's norm is 'linf', linear programs minimise the largest error at the points of the
   sample. The points outside the sample that have the largest errors are then added to it, and the
   step is repeated. This is called exchange. If no such point is found any more, a search by bounds
   on boxes looks for further ones, where there is one for the form (`Counterexamples`).
3. If the goal has a rounding, the coefficients are rounded in groups, those whose rounding changes
   the values most first. After each group, the coefficients that are not yet rounded are refitted.
"""

from dataclasses import dataclass, field

import numpy as np

from fitting.form import Form
from fitting.goal import Goal
from fitting.points.sample import SEED, Sample, sample_of
from fitting.solvers.elsewhere import Counterexamples, Elsewhere, problem_at
from fitting.solvers.minimax import Minimax
from fitting.solvers.on_grid import Progress
from fitting.solvers.residuals import Residuals, badness, limits
from fitting.solvers.scattered_squares import fit_squares
from fitting.solvers.starts import quotient_starts

PRECISIONS = {"float32": np.float32, "float16": np.float16}
# A part of a denominator that is nowhere larger than this, relative to all of it, has no influence
# on the values: the other coefficients have grown.
_NEGLIGIBLE = 1e-6
SQUARES = "trust region (SciPy)"


@dataclass(frozen=True)
class ScatteredFit:
    """The result of a fit to scattered points.

    * `coefficients` (m,): flat. `sample`: the points on which they were fitted.
    * `converged`: for least squares, whether no small step lowers the sum of squares; for the
      largest error, whether it is the same elsewhere as at the points, to the fraction `settled`.
    * `solver`: the solver, in words, and whether it did not converge.
    """

    coefficients: np.ndarray
    sample: Sample
    converged: bool
    solver: str


@dataclass(frozen=True)
class Exchange:
    """The solver of fits to scattered points, with its tuning constants.

    * `steps`: the most steps of least squares. A form with more than `many` coefficients takes at
      most `steps_of_many`, because each of its steps is slow, and does not try further starts.
    * `worthwhile`: for the largest error, least squares give only the start, and end when a step
      promises to lower the sum of squares by less than this fraction.
    * `exchanges`, `exchanged`, `settled`: at most `exchanges` times, up to `exchanged` points with
      the largest errors outside the sample are added to it, and those that a search finds. The
      exchange ends when their largest error exceeds that of the sample by at most the fraction
      `settled`.
    * `searches`, `above`: if there is a search by bounds, it looks at most `searches` times for
      errors that exceed that of the sample by more than the fraction `above`.
    * `turns`: the number of groups in which the coefficients are rounded.
    * `minimax`: minimises the largest error. `minimax_of_rounding` does so after each group is
      rounded.
    """

    steps: int = 1000
    steps_of_many: int = 200
    many: int = 20
    worthwhile: float = 1e-8
    exchanges: int = 12
    exchanged: int = 300
    settled: float = 5e-5
    searches: int = 8
    above: float = 5e-4
    turns: int = 4
    minimax: Minimax = field(default_factory=Minimax)
    minimax_of_rounding: Minimax = field(default_factory=lambda: Minimax(programs=20))

    def fit(
        self,
        form: Form,
        goal: Goal,
        measure: str,
        start: np.ndarray | None,
        progress: Progress,
        counterexamples: Counterexamples | None = None,
    ) -> ScatteredFit:
        """Fit a form to the points of its quantity.

        `start`, flat coefficients, replaces the form's own starts. `progress` is called with a text
        before each step. `counterexamples` searches for larger errors than those at the points; it
        is used if errors are neither weighted nor one-sided. Raises ValueError if no start leads to
        a form without poles.
        """
        progress(f"exact {form.reference.symbol} where {form.name} is fitted")
        sample = sample_of(form, goal, measure)
        progress(f"{form.name}: least squares")
        found, converged, words = self.least_squares(form, sample, goal, start)
        if goal.norm == "linf":
            progress(f"{form.name}: least largest error")
            search = counterexamples if _is_plain(goal, sample) else None
            found, sample, converged = self._least_largest(
                form, sample, goal, measure, found, search
            )
            words = f"{SQUARES}; linear programs (HiGHS)"
            if not converged:
                words += f"; the largest error did not settle in {self.exchanges} exchanges"
        largest = _running_away(problem_at(form, sample, goal), found)
        if largest is not None:
            converged = False
            name = np.ravel(form.coefficient_names)[largest]
            words += (
                "; coefficients grow without limit: let another term of the denominator be 1, "
                f"such as that of {name}"
            )
        if goal.rounding != "none":
            progress(f"{form.name}: rounding to {goal.rounding}")
            found = self._rounded(form, sample, goal, found)
        return ScatteredFit(found, sample, converged, words)

    def least_squares(
        self, form: Form, sample: Sample, goal: Goal, start: np.ndarray | None = None
    ) -> tuple[np.ndarray, bool, str]:
        """Return flat coefficients, whether the descent converged, and the solver in words.

        The starts are `start`, or else those of the form and, for a quotient of linear functions,
        those of `quotient_starts`. Raises ValueError if there is no start, and if no start leads to
        a form without poles.
        """
        problem = problem_at(form, sample, goal)
        starts = list(form.starts) if start is None else [start]
        linear = problem.parts is not None and not np.any(problem.parts.b)
        if start is None and (linear or not starts):
            starts = quotient_starts(problem)
            if problem.parts is None:
                raise ValueError(f"{form.name} has no starts: give one")
            if not starts:
                raise ValueError(
                    f"{form.name}: no coefficients were found that make its denominator positive "
                    "at all points; try other monomials"
                )
        many = len(starts[0]) > self.many
        found = fit_squares(
            problem,
            starts,
            self.steps_of_many if many else self.steps,
            1e-15 if goal.norm == "l2" else self.worthwhile,
            0 if many or goal.norm != "l2" else 3,
        )
        if found is None and start is None and form.starts:
            found = fit_squares(problem, quotient_starts(problem) or starts, self.steps)
        if found is None:
            raise ValueError(f"{form.name}: no start gives a form without poles")
        words = "QR" if linear else SQUARES
        return found.z, found.converged, f"{words}; {found.words}" if found.words else words

    def _least_largest(
        self,
        form: Form,
        sample: Sample,
        goal: Goal,
        measure: str,
        start: np.ndarray,
        search: Counterexamples | None,
    ) -> tuple[np.ndarray, Sample, bool]:
        """Minimise the largest error, adding points with larger errors to the sample in turn.

        Returns the coefficients with the least largest error at all points that were found, the
        extended sample, and whether the last largest error is nowhere larger.
        """
        if form.reference.data is not None:
            # Data have no values elsewhere: the rows that are held out judge the fit.
            return self.minimax(problem_at(form, sample, goal), start, goal.side), sample, True
        every, found, settled = [start], start, not len(start)
        searches, turn, last = self.searches, 0, self.exchanges
        while turn < last and len(start):
            problem = problem_at(form, sample, goal)
            found = self.minimax(problem, found, goal.side)
            every.append(found)
            sizes = badness(problem.values(found), *limits(problem, goal.side))
            elsewhere = Elsewhere(form, found, goal, measure, SEED + 2 + turn)
            worst, size = elsewhere.worst(self.exchanged, sample, sizes)
            settled = bool(size <= sizes.max() * (1 + self.settled))
            turn += 1
            if search is not None and searches and (settled or turn == last):
                searches -= 1
                # Of a bounded fit, the size may count more than the error.
                largest = np.abs(problem.values(found)).max()
                points = search(form.fitted(found), largest * (1 + self.above))
                settled = not len(points) and bool(size <= sizes.max() * (1 + self.above))
                if len(points):
                    worst, last = elsewhere.uphill(points), turn + self.exchanges
            if settled:
                break
            sample = sample.extended(worst)
        problem = problem_at(form, sample, goal)
        good = [z for z in every if problem.is_good(z)] or [found]
        allowed = limits(problem, goal.side)
        best = min(good, key=lambda z: badness(problem.values(z), *allowed).max(initial=0.0))
        return best, sample, settled

    def _rounded(self, form: Form, sample: Sample, goal: Goal, found: np.ndarray) -> np.ndarray:
        """Round the coefficients in groups. After each, refit those that are not yet rounded.

        Raises ValueError for a coefficient that is too large for the precision.
        """
        dtype = PRECISIONS[goal.rounding]
        slopes = problem_at(form, sample, goal).slopes(found, np.arange(len(sample.exact)))
        # The coefficients whose rounding may change the values most come first.
        order = np.argsort(-np.abs(found) * np.max(np.abs(slopes), axis=0, initial=0.0))
        free, found = np.full(len(found), True), found.copy()
        for turn in np.array_split(order, min(self.turns, max(len(order), 1))):
            _require_range(form, found, goal.rounding)
            found[turn] = found[turn].astype(dtype).astype(float)
            free[turn] = False
            if free.any():
                problem = problem_at(form, sample, goal, free, found)
                found[free] = self._refitted(problem, found[free], goal)
        return found

    def _refitted(self, problem: Residuals, start: np.ndarray, goal: Goal) -> np.ndarray:
        if goal.norm == "linf":
            return self.minimax_of_rounding(problem, start, goal.side)
        slopes = problem.slopes(start, np.arange(len(problem.values(start))))
        return start - np.linalg.lstsq(slopes, problem.values(start), rcond=None)[0]


def _is_plain(goal: Goal, sample: Sample) -> bool:
    """Whether the fit minimises the largest error, neither weighted nor one-sided."""
    return goal.norm == "linf" and goal.side == "both" and bool(np.all(sample.scale == 1))


def _running_away(problem: Residuals, z: np.ndarray) -> int | None:
    """Return the coefficient of the largest term of a denominator, if coefficients run away.

    They do if the part of a quotient's denominator without coefficients has become negligible. Then
    the best denominator has not that part, or has it with the other sign, so that all other
    coefficients grow. None: they do not.
    """
    parts = problem.parts
    if parts is None or not np.any(parts.b):
        return None
    below = parts.b0 + parts.b @ z
    if np.any(np.abs(parts.b0) > _NEGLIGIBLE * np.abs(below)):
        return None
    return int(np.argmax(np.mean(parts.b / below[:, None], axis=0) * z))


def _require_range(form: Form, found: np.ndarray, rounding: str) -> None:
    largest = float(np.finfo(PRECISIONS[rounding]).max)
    worst = int(np.argmax(np.abs(found))) if len(found) else None
    if worst is not None and not np.abs(found[worst]) <= largest:
        name = str(np.ravel(form.coefficient_names)[worst])
        raise ValueError(
            f"{form.name}: the coefficient {name!r} = {found[worst]:.6g} is too large for "
            f"{rounding}: allowed are −{largest:.6g} to {largest:.6g}; scale the form's terms"
        )
