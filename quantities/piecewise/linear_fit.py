"""The values of an NDF at its knots by two linear programs.

All that is asked of an NDF is linear in its values. The first program minimises the total variation
∫ |D − D_target| under D ≥ 0 and equations such as that of the mass. The second minimises the
largest error of G1, to first order, while the total variation may grow to `TRADE` times its least
value.
"""

from dataclasses import dataclass

import numpy as np

from fitting.solvers.linear_programs import solve_program

# By how much the second program may increase the total variation.
TRADE = 1.25
# Below this error of G1 there is nothing to gain.
_EXACT = 1e-12


@dataclass(frozen=True, eq=False)
class Rows:
    """What is linear in the values (n,), which are divided by a scale of each.

    * `equal` (e, n) and `wanted` (e,): equations, of the order of one.
    * `least` (m, n): rows that must not be positive.
    * `density` (k, n) and `target` (k,): D at points, times their share of the measure.
    * `masking` (d, n) and `exact` (d,): H of directions, times dG1/dH.
    """

    equal: np.ndarray
    wanted: np.ndarray
    least: np.ndarray
    density: np.ndarray
    target: np.ndarray
    masking: np.ndarray
    exact: np.ndarray


def fitted_values(rows: Rows) -> np.ndarray:
    """Return the values (n,) of both programs. Raises ValueError if the first has no solution."""
    knots = rows.equal.shape[1]
    first = _least_variation(rows)
    if first is None:
        raise ValueError("no NDF at these knots has the mass and the moment of the target")
    own = np.abs(rows.masking @ first[:knots] - rows.exact).max()
    if own < _EXACT:
        return first[:knots]
    second = _least_masking(rows, first[knots:].sum(), own)
    return np.maximum((first if second is None else second)[:knots], 0.0)


def _limits(rows: Rows) -> tuple[np.ndarray, np.ndarray]:
    """Return the matrix and the limits of the first program, for values and gaps e.

    |D − D_target| ≤ e at every point, in units of the measure's share.
    """
    points = len(rows.target)
    bound = -np.eye(points)
    fixed = np.concatenate([rows.equal, -rows.equal, rows.least])
    matrix = np.block(
        [
            [fixed, np.zeros((len(fixed), points))],
            [rows.density, bound],
            [-rows.density, bound],
        ]
    )
    ends = [rows.wanted, -rows.wanted, np.zeros(len(rows.least)), rows.target, -rows.target]
    return matrix, np.concatenate(ends)


def _least_variation(rows: Rows) -> np.ndarray | None:
    """Return the values, and the gaps, of the least total variation; None if there are none."""
    matrix, limit = _limits(rows)
    knots, points = rows.density.shape[1], len(rows.target)
    cost = np.concatenate([np.zeros(knots), np.ones(points)])
    return solve_program(cost, matrix, limit, [(0, None)] * (knots + points))


def _least_masking(rows: Rows, variation: float, own: float) -> np.ndarray | None:
    """Return values, gaps, and the largest error of G1 in units of `own`, which the first has."""
    matrix, limit = _limits(rows)
    knots, points = rows.density.shape[1], len(rows.target)
    masking = rows.masking / own
    column = -np.ones((len(masking), 1))
    none = np.zeros((len(masking), points))
    matrix = np.block(
        [
            [matrix, np.zeros((len(matrix), 1))],
            [np.zeros((1, knots)), np.full((1, points), 1 / variation), np.zeros((1, 1))],
            [masking, none, column],
            [-masking, none, column],
        ]
    )
    limit = np.concatenate([limit, [TRADE], rows.exact / own, -rows.exact / own])
    cost = np.concatenate([np.zeros(knots + points), [1.0]])
    return solve_program(cost, matrix, limit, [(0, None)] * (knots + points + 1))
