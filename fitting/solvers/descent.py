"""A descent to the least sum of squares from one start, with a verdict on convergence.

SciPy's trust region method minimises the linearised residual within a region that is measured in
the scale of the Jacobian's columns, because coefficients may differ in size by many orders.
Gauss–Newton steps at the end find the digits that the sum of squares, which is flat there, does not
show.
"""

import contextlib
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

Residual = Callable[[np.ndarray], np.ndarray]
Jacobian = Callable[[np.ndarray], np.ndarray]

# The search ends if a step changes the coefficients by less than this part.
_LEAST_STEP = 1e-15
# At most so many Gauss–Newton steps follow.
_POLISHED = 100
# A singular value of the scaled Jacobian below this part of the largest is rounding.
_RANK = 1e-13
# A fit has converged if the cosine of the angle of the residual with the space of the Jacobian's
# columns is at most this, or if the Gauss–Newton step is at most this part of the coefficients.
CONVERGED_COSINE, CONVERGED_STEP = 1e-6, 1e-8


@dataclass(frozen=True)
class Descent:
    """Where a descent ended.

    * `z` (m,): the coefficients. `norm`: the root of the sum of squares; ∞ if it is not finite.
    * `converged`: whether the end is a stationary point: no small step lowers the sum of squares.
    """

    z: np.ndarray
    norm: float
    converged: bool


def descend(
    residual: Residual,
    jacobian: Jacobian,
    start: np.ndarray,
    steps: int = 1000,
    worthwhile: float = 1e-15,
) -> Descent:
    """Minimise |residual(z)|² from `start` (m,).

    `residual` maps z to (n,) and `jacobian` to (n, m). A z whose residual is not finite is not
    entered, so that a function may return ∞ where z is not allowed. `steps` is the largest number
    of residuals. The descent ends if a step lowers the sum of squares by less than the fraction
    `worthwhile`; the rounding of the sum hides gains below 1e-15.
    """
    from scipy.optimize import least_squares  # noqa: PLC0415  slow to import

    best = Descent(np.asarray(start, float), np.inf, False)

    def tried(z: np.ndarray) -> np.ndarray:
        nonlocal best
        r = residual(z)
        norm = float(np.linalg.norm(r))
        if norm < best.norm:
            best = Descent(z.copy(), norm, False)
        # A residual whose square overflows is none to go to.
        return r if np.isfinite(norm) else np.full(len(r), np.inf)

    with np.errstate(all="ignore"):
        if not np.isfinite(tried(best.z)).all():
            return best
        # If the Jacobian is not finite somewhere, the best point before that is the end.
        with contextlib.suppress(ValueError, np.linalg.LinAlgError):
            least_squares(
                tried,
                best.z,
                jacobian,
                x_scale="jac",
                ftol=worthwhile,
                xtol=_LEAST_STEP,
                gtol=None,
                max_nfev=steps,
            )
        return _polished(residual, jacobian, best.z, worthwhile)


def _polished(residual: Residual, jacobian: Jacobian, z: np.ndarray, worthwhile: float) -> Descent:
    """Take Gauss–Newton steps while they shrink, then tell whether the end is stationary."""
    r, last, cosine = residual(z), np.inf, np.inf
    for _ in range(_POLISHED if worthwhile <= 1e-12 else 1):
        matrix, size = jacobian(z), float(np.linalg.norm(r))
        norms = np.linalg.norm(matrix, axis=0)
        if not np.isfinite(matrix).all() or not norms.any():
            break
        unit = np.where(norms > 0, norms, 1.0)
        step = np.linalg.lstsq(matrix / unit, -r, rcond=_RANK)[0]
        length = float(np.linalg.norm(step)) / (np.linalg.norm(unit * z) or 1.0)
        cosine = float(np.linalg.norm(matrix @ (step / unit))) / size if size else 0.0
        if not length < 0.95 * last or length > 1e-3 or length < _LEAST_STEP:
            last = min(length, last)
            break
        last = length
        moved = residual(z + step / unit)
        # The sum of squares may rise by its rounding, not by more.
        if not np.linalg.norm(moved) <= size * (1 + 1e-9):
            break
        z, r = z + step / unit, moved
    converged = cosine <= CONVERGED_COSINE or last <= CONVERGED_STEP
    return Descent(z, float(np.linalg.norm(r)), bool(converged))
