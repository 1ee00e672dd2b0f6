"""The least largest error of a quotient under constraints that are linear in its coefficients.

The constraints are that none of the form's margins (`Proofs.margins`) is negative. They are affine
functions of the coefficients. So the coefficients with an error of at most t that obey them are a
convex set, and a sequence of linear programs finds the least t (differential correction, as in
`minimax`). A program has only some of the points and margins. Where its result is worst, points and
margins are added, and the next program is solved.
"""

from dataclasses import dataclass, replace

import jax
import jax.numpy as jnp
import numpy as np

from fitting.form import Form
from fitting.goal import Goal
from fitting.linearity import LinearParts, linear_parts
from fitting.points.sample import SEED, sample_of
from fitting.proofs.pole_proof import proof_axes
from fitting.solvers.elsewhere import Counterexamples, Elsewhere
from fitting.solvers.exchange import PRECISIONS, ScatteredFit
from fitting.solvers.linear_programs import LOWERED, solve_program
from fitting.solvers.on_grid import Progress
from integrals.reference import box_of

# Margins that differ from affine functions by more than this part of themselves are refused.
_AFFINE = 1e-9


@dataclass(frozen=True)
class WithinMargins:
    """The solver with its tuning constants.

    * `room`: the least margin at the nodes of a program. It keeps margins between them from being
      negative.
    * `most`: the largest size of a coefficient. Without it, large denominators would make a program
      unbounded.
    * `first`: at first, one of `first` points is in the programs.
    * `nodes`: margins are computed on a grid with this many nodes an axis.
    * `coarse`: at first, one of `coarse` margins of the grid is in the programs.
    * `programs`, `worthwhile`: at most `programs` follow each other, as long as each lowers the
      largest error by the fraction `worthwhile`.
    * `exchanges`, `added`: at most `exchanges` times, up to `added` points with the largest errors
      outside the sample are added to it.
    * `settled`: the exchange ends when their largest error exceeds that of the sample by at most
      this fraction.
    * `turns`: the number of groups in which the coefficients are rounded.
    """

    room: float = 1e-4
    most: float = 100.0
    first: int = 6
    nodes: int = 65
    coarse: int = 4
    programs: int = 30
    worthwhile: float = 1e-4
    exchanges: int = 12
    added: int = 100
    settled: float = 5e-4
    turns: int = 4

    def fit(
        self,
        form: Form,
        goal: Goal,
        measure: str,
        start: np.ndarray | None,
        progress: Progress,
        counterexamples: Counterexamples | None = None,
    ) -> ScatteredFit:
        """Fit a form to the points of its quantity; the arguments are those of `Exchange.fit`.

        The start and the search are not used. Raises ValueError for a goal other than the plain
        largest error, for a form that is no quotient or has margins that are not affine, and if
        no coefficients obey the constraints.
        """
        if goal.norm != "linf" or goal.side != "both" or goal.relative:
            raise ValueError(f"{form.name}: allowed is the goal norm = 'linf', side = 'both'")
        progress(f"exact {form.reference.symbol} where {form.name} is fitted")
        sample = sample_of(form, goal, measure)
        progress(f"{form.name}: least largest error within its margins")
        margins = _margins(form, self.nodes)
        kept = np.zeros(len(margins.constants), bool)
        kept[:: self.coarse] = True
        chosen = np.zeros(len(sample.points), bool)
        chosen[:: self.first] = True
        free = np.full(form.size, True)
        z, settled, plain = np.zeros(form.size), False, replace(goal, bounded=False)
        for turn in range(self.exchanges):
            parts = _parts(form, sample.points)
            while True:
                z = self._least(
                    parts.some(chosen), sample.exact[chosen], margins.some(kept), z, free
                )
                size = np.abs(parts.values(z) - sample.exact)
                worse = size > size[chosen].max() * (1 + self.settled)
                short = margins.values(z) < self.room / 2
                if not (worse.any() or short.any()):
                    break
                chosen |= worse & (size >= np.sort(size)[-self.added :].min())
                kept |= short
            elsewhere = Elsewhere(form, z, plain, measure, SEED + 2 + turn)
            worst, largest = elsewhere.worst(self.added, sample, size)
            settled = bool(largest <= size.max() * (1 + self.settled))
            if settled:
                break
            sample = sample.extended(worst)
            chosen = np.concatenate([chosen, np.full(len(worst.points), True)])
        words = "linear programs (HiGHS) within margins"
        if not settled:
            words += f"; the largest error did not settle in {self.exchanges} exchanges"
        if goal.rounding != "none":
            progress(f"{form.name}: rounding to {goal.rounding}")
            parts = _parts(form, sample.points).some(chosen)
            z = self._rounded(parts, sample.exact[chosen], margins.some(kept), z, goal)
        return ScatteredFit(z, sample, settled, words)

    def _rounded(
        self, parts: LinearParts, exact: np.ndarray, margins: "_Margins", z: np.ndarray, goal: Goal
    ) -> np.ndarray:
        """Round the coefficients in groups, those that change the values most first."""
        dtype = PRECISIONS[goal.rounding]
        order = np.argsort(-np.abs(z) * np.abs(parts.a - exact[:, None] * parts.b).max(axis=0))
        free, z = np.full(len(z), True), z.copy()
        for group in np.array_split(order, self.turns):
            z[group] = z[group].astype(dtype).astype(float)
            free[group] = False
            if free.any():
                z = self._least(parts, exact, margins, z, free)
        return z

    def _least(
        self,
        parts: LinearParts,
        exact: np.ndarray,
        margins: "_Margins",
        z: np.ndarray,
        free: np.ndarray,
    ) -> np.ndarray:
        """Return the coefficients with the least largest error; those not free keep their values.

        The programs begin with the error of `z`, which need not obey the constraints; their results
        do.
        """
        held = np.where(free, 0.0, z)
        a0, b0 = parts.a0 + parts.a @ held, parts.b0 + parts.b @ held
        a, b, matrix = parts.a[:, free], parts.b[:, free], margins.slopes[:, free]
        above, slopes = a0 - exact * b0, a - exact[:, None] * b
        base = margins.values(held)
        start = z[free]
        below = b0 + b @ start
        size, best = np.abs((above + slopes @ start) / below).max(), None
        # Points with the same denominator need one row.
        _, once = np.unique(np.column_stack([b0, b]), axis=0, return_index=True)
        fixed = np.concatenate([-matrix, -b[once]])
        fixed = np.column_stack([fixed, np.zeros(len(fixed))])
        for _ in range(self.programs):
            limits = [b0 - sign * above / size for sign in (1, -1)]
            limits += [base - self.room, b0[once] - LOWERED * below[once]]
            rows = [np.column_stack([sign * slopes / size - b, -below]) for sign in (1, -1)]
            found = solve_program(
                np.append(np.zeros(a.shape[1]), 1.0),
                np.concatenate([*rows, fixed]),
                np.concatenate(limits),
                [(-self.most, self.most)] * a.shape[1] + [(None, None)],
            )
            if found is None:
                break
            trial = found[:-1]
            new_below = b0 + b @ trial
            new = np.abs((above + slopes @ trial) / new_below).max()
            if best is not None and new > size * (1 - self.worthwhile):
                break
            best, below, size = trial, new_below, new
        if best is None:
            raise ValueError("no coefficients obey the constraints of the form")
        whole = z.copy()
        whole[free] = best
        return whole


@dataclass(frozen=True)
class _Margins:
    """Margins as affine functions of the coefficients: constants (n,) and slopes (n, size)."""

    constants: np.ndarray
    slopes: np.ndarray

    def some(self, chosen: np.ndarray) -> "_Margins":
        return _Margins(self.constants[chosen], self.slopes[chosen])

    def values(self, z: np.ndarray) -> np.ndarray:
        return self.constants + self.slopes @ z


def _parts(form: Form, points: np.ndarray) -> LinearParts:
    found = linear_parts(form, points)
    if found is None:
        raise ValueError(f"{form.name} is no quotient of linear functions of its coefficients")
    return found


def _margins(form: Form, nodes: int) -> _Margins:
    """Return the margins on a grid with so many nodes an axis."""
    margins = form.proofs.margins
    if margins is None:
        raise ValueError(f"{form.name} has no margins")
    ends = box_of(proof_axes(form))
    axes = [np.linspace(*each, nodes) for each in ends]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(ends))
    probe = np.random.default_rng(SEED).standard_normal(form.size)
    given = np.concatenate([np.zeros((1, form.size)), np.eye(form.size), probe[None]])

    def at(c, point):
        return jnp.stack(margins(c, *point))

    over = jax.jit(jax.vmap(jax.vmap(at, (None, 0)), (0, None)))
    values = np.asarray(over(given, points))
    # (coefficients, points, margins) to rows
    flat = values.reshape(len(given), -1)
    slopes = (flat[1:-1] - flat[0]).T
    apart = np.abs(flat[0] + slopes @ probe - flat[-1]).max()
    if not apart <= _AFFINE * np.abs(flat[-1]).max():
        raise ValueError(f"{form.name}: its margins are not affine in the coefficients")
    return _Margins(flat[0], slopes)
