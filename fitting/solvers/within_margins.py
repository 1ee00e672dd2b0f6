"""The least largest error of a quotient under constraints that are linear in its coefficients.

The constraints are that none of the form's margins (`Proofs.margins`) is negative. They are affine
functions of the coefficients. So the coefficients with an error of at most t that obey them are a
convex set, and a sequence of linear programs finds the least t (differential correction, as in
`minimax`). The programs have some of the points; those where their result is worst are added.
"""

from dataclasses import dataclass, replace

import jax
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

    * `room`: at the points of a program no margin is less than this, so that none is negative
      between them. `most` is the largest size of a coefficient: without it, large denominators
      would make a program unbounded.
    * `first`: a program has every so many-th point at first. `nodes`: the margins are looked at on
      a grid of so many nodes an axis, and every so many-th of `coarse` is there at first.
    * `programs`, `worthwhile`: at most so many programs follow each other, while each lowers the
      error by this fraction. `exchanges`, `added`: at most so many times, so many points are added.
    * `settled`: the largest error may exceed that at the points by this fraction.
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
        rooms = _rooms(form, self.nodes)
        kept = np.zeros(len(rooms[0]), bool)
        kept[:: self.coarse] = True
        chosen = np.zeros(len(sample.points), bool)
        chosen[:: self.first] = True
        free = np.full(form.size, True)
        z, settled, plain = np.zeros(form.size), False, replace(goal, bounded=False)
        for turn in range(self.exchanges):
            parts = _parts(form, sample.points)
            while True:
                z = self._least(
                    _some(parts, chosen), sample.exact[chosen], _rows(rooms, kept), z, free
                )
                size = np.abs(_errors(parts, sample.exact, z))
                worse = size > size[chosen].max() * (1 + self.settled)
                short = rooms[0] + rooms[1] @ z < self.room / 2
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
            parts = _some(_parts(form, sample.points), chosen)
            z = self._rounded(parts, sample.exact[chosen], _rows(rooms, kept), z, goal)
        return ScatteredFit(z, sample, settled, words)

    def _rounded(self, parts, exact, rooms, z, goal: Goal) -> np.ndarray:
        """Round the coefficients in groups, those that change the values most first."""
        dtype = PRECISIONS[goal.rounding]
        order = np.argsort(-np.abs(z) * np.abs(parts.a - exact[:, None] * parts.b).max(axis=0))
        free, z = np.full(len(z), True), z.copy()
        for group in np.array_split(order, self.turns):
            z[group] = z[group].astype(dtype).astype(float)
            free[group] = False
            if free.any():
                z = self._least(parts, exact, rooms, z, free)
        return z

    def _least(self, parts: LinearParts, exact, rooms, z, free) -> np.ndarray:
        """Return the coefficients with the least largest error; those not free keep their values.

        The programs begin with the error of `z`, which need not obey the constraints; their results
        do.
        """
        held = np.where(free, 0.0, z)
        a0, b0 = parts.a0 + parts.a @ held, parts.b0 + parts.b @ held
        a, b, matrix = parts.a[:, free], parts.b[:, free], rooms[1][:, free]
        above, slopes = a0 - exact * b0, a - exact[:, None] * b
        base = rooms[0] + rooms[1] @ held
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


def _parts(form: Form, points: np.ndarray) -> LinearParts:
    found = linear_parts(form, points)
    if found is None:
        raise ValueError(f"{form.name} is no quotient of linear functions of its coefficients")
    return found


def _some(parts: LinearParts, chosen: np.ndarray) -> LinearParts:
    return LinearParts(parts.a0[chosen], parts.a[chosen], parts.b0[chosen], parts.b[chosen])


def _rows(rooms: tuple[np.ndarray, np.ndarray], kept: np.ndarray):
    return rooms[0][kept], rooms[1][kept]


def _errors(parts: LinearParts, exact: np.ndarray, z: np.ndarray) -> np.ndarray:
    return (parts.a0 + parts.a @ z) / (parts.b0 + parts.b @ z) - exact


def _rooms(form: Form, nodes: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the margins on a grid as affine functions: constants (n,) and slopes (n, size)."""
    margins = form.proofs.margins
    if margins is None:
        raise ValueError(f"{form.name} has no margins")
    ends = box_of(proof_axes(form))
    axes = [np.linspace(*each, nodes) for each in ends]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(ends))
    probe = np.random.default_rng(SEED).standard_normal(form.size)
    given = np.concatenate([np.zeros((1, form.size)), np.eye(form.size), probe[None]])

    def at(c, point):
        return jax.numpy.stack(margins(c, *point))

    over = jax.jit(jax.vmap(jax.vmap(at, (None, 0)), (0, None)))
    values = np.asarray(over(given, points))
    # (coefficients, points, margins) to rows
    flat = values.reshape(len(given), -1)
    slopes = (flat[1:-1] - flat[0]).T
    apart = np.abs(flat[0] + slopes @ probe - flat[-1]).max()
    if not apart <= _AFFINE * np.abs(flat[-1]).max():
        raise ValueError(f"{form.name}: its margins are not affine in the coefficients")
    return flat[0], slopes
