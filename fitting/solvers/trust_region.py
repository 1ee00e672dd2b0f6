"""Least squares by a trust region, with the same steps as SciPy's, to the last digit.

The method is that of J. J. Moré, "The Levenberg-Marquardt algorithm: implementation and theory"
(1978), with the singular values of the Jacobian instead of normal equations. It is
`scipy.optimize.least_squares(method="trf", x_scale="jac")` without what that does around each step,
which takes longer than the steps of small problems.
"""

import functools
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

# A step has the length of the radius to this fraction, or is found in so many trials.
_RADIUS_TOLERANCE, _TRIALS = 0.01, 10
# The gain of a step is poor or good if it is below or above these parts of what was promised. The
# radius is then made smaller than the step by the factor, or is doubled.
_POOR, _GOOD, _SMALLER = 0.25, 0.75, 0.25
# The first damping is at least this part of the largest that is possible.
_LEAST_DAMPING = 0.001


def search(
    residual: Callable[[np.ndarray], np.ndarray],
    jacobian: Callable[[np.ndarray], np.ndarray],
    z: np.ndarray,
    r: np.ndarray,
    steps: int,
    worthwhile: float,
    least_step: float,
) -> None:
    """Evaluate `residual` (n,) at coefficients (m,) with ever smaller sums of squares.

    It begins at `z`, where the residual is `r`; who calls it keeps the best point. It ends after
    `steps` residuals, with that of the start, after a step that lowers the sum of squares by less
    than the fraction `worthwhile`, after a step that is shorter than the fraction `least_step` of
    the coefficients, and where the Jacobian (n, m) is not finite. Where a residual is not finite,
    the radius shrinks.
    """
    cost = 0.5 * r.dot(r)
    matrix = jacobian(z)
    norms = _norms_of_columns(matrix)
    norms[norms == 0] = 1
    radius = _norm(z * norms) or 1.0
    damping, count = 0.0, 1
    while count < steps:
        scale = 1 / norms
        gradient, scaled = scale * matrix.T.dot(r), matrix * scale
        model = _model(scaled, r)
        if model is None:
            return
        gain = -1.0
        while gain <= 0 and count < steps:
            y, damping = model.step(radius, damping)
            change = scaled.dot(y)
            promised = -(0.5 * change.dot(change) + y.dot(gradient))
            step = scale * y
            moved = residual(z + step)
            count += 1
            length, new_cost = _norm(y), 0.5 * moved.dot(moved)
            if not np.isfinite(new_cost):
                radius = _SMALLER * length
                continue
            gain = cost - new_cost
            ratio = gain / promised if promised > 0 else float(promised == gain == 0)
            new_radius = radius
            if ratio < _POOR:
                new_radius = _SMALLER * length
            elif ratio > _GOOD and length > 0.95 * radius:
                new_radius = 2.0 * radius
            idle = gain < worthwhile * cost and ratio > _POOR
            if idle or _norm(step) < least_step * (least_step + _norm(z)):
                return
            damping *= radius / new_radius
            radius = new_radius
        if gain > 0:
            z, r, cost = z + step, moved, new_cost
            matrix = jacobian(z)
            norms = np.maximum(_norms_of_columns(matrix), norms)


@dataclass(frozen=True)
class _Model:
    """The linearised problem |a·y + r|² by the singular values of the matrix a (n, m).

    * `singular`: the singular values. `right` (m, k): the right singular vectors, in columns.
    * `along` (k,): the components of r along the left singular vectors.
    * `full`: whether the matrix has full rank.
    """

    singular: np.ndarray
    right: np.ndarray
    along: np.ndarray
    full: bool

    def step(self, radius: float, damping: float) -> tuple[np.ndarray, float]:
        """Return the y with |y| ≤ radius that minimises the model, and its damping.

        The damping λ makes |y(λ)| equal to the radius, where y(λ) minimises |a·y + r|² + λ|y|². The
        search for it begins at `damping`, that of the last step.
        """
        if self.full:
            y = -self.right.dot(self.along / self.singular)
            if _norm(y) <= radius:
                return y, 0.0
        weighted, squares = self.singular * self.along, self.singular**2
        above, below = _norm(weighted) / radius, 0.0
        if self.full:
            excess, slope = _excess(0.0, weighted, squares, radius)
            below = -excess / slope
        usual = not (damping == 0 and not self.full)
        trial = damping if usual else max(_LEAST_DAMPING * above, (below * above) ** 0.5)
        for _ in range(_TRIALS):
            if trial < below or trial > above:
                trial = max(_LEAST_DAMPING * above, (below * above) ** 0.5)
            excess, slope = _excess(trial, weighted, squares, radius)
            if excess < 0:
                above = trial
            newton = excess / slope
            below = max(below, trial - newton)
            trial = trial - (excess + radius) * newton / radius
            if abs(excess) < _RADIUS_TOLERANCE * radius:
                break
        y = -self.right.dot(weighted / (squares + trial))
        return y * (radius / _norm(y)), trial


def _model(matrix: np.ndarray, r: np.ndarray) -> _Model | None:
    """Return the model at the present coefficients; None if it has no singular values."""
    if not np.isfinite(matrix).all():
        return None
    try:
        left, singular, right = _decomposed(matrix)
    except np.linalg.LinAlgError:
        return None
    rows, columns = matrix.shape
    least = np.finfo(float).eps * rows * singular[0]
    full = rows >= columns and bool(singular[-1] > least)
    return _Model(singular, right.T, left.T.dot(r), full)


def _decomposed(matrix: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the thin singular value decomposition by LAPACK's gesdd, as `scipy.linalg.svd` does.

    NumPy's function hands the transposed matrix to LAPACK, which gives other last digits.
    """
    gesdd, size = _gesdd(*matrix.shape)
    left, singular, right, info = gesdd(matrix, compute_uv=True, full_matrices=False, lwork=size)
    if info != 0:
        raise np.linalg.LinAlgError(f"gesdd: {info}")
    return left, singular, right


@functools.lru_cache(maxsize=64)
def _gesdd(rows: int, columns: int) -> tuple[Callable[..., Any], int]:
    """Return LAPACK's function, and its best work space for the shape of a matrix.

    The size of blocks, and so the last digits, depend on the work space.
    """
    from scipy.linalg import get_lapack_funcs  # noqa: PLC0415  slow to import

    gesdd, work_space = get_lapack_funcs(("gesdd", "gesdd_lwork"), dtype=float)
    return gesdd, int(work_space(rows, columns, compute_uv=True, full_matrices=False)[0])


def _excess(damping, weighted, squares, radius) -> tuple[Any, Any]:
    """Return |y(λ)| less the radius, and its derivative in λ."""
    divisor = squares + damping
    length = _norm(weighted / divisor)
    return length - radius, -np.add.reduce(weighted**2 / divisor**3) / length


def _norms_of_columns(matrix: np.ndarray) -> np.ndarray:
    return np.add.reduce(matrix**2, axis=0) ** 0.5


def _norm(x: np.ndarray) -> Any:
    return np.sqrt(x.dot(x))
