"""Levenberg–Marquardt by QR, with scaled coefficients and a verdict on convergence.

It is for fits to scattered points, whose coefficients may differ in size by many orders. Each step
minimises the linearised residual within a trust region (Moré 1978): the changes of the
coefficients, times the largest norms that their columns of the Jacobian have had, are limited
together. The QR decomposition of the Jacobian does not square its condition number, as normal
equations would. Gauss–Newton steps at the end find the digits that the sum of squares, which is
flat there, does not show.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

Residual = Callable[[np.ndarray], np.ndarray]
Jacobian = Callable[[np.ndarray], np.ndarray]

# A step is taken if the sum of squares falls by this part of what the linearised residual promises.
_WORTHWHILE = 1e-4
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


@dataclass(frozen=True)
class _Tangent:
    """The linearised residual at z: the singular values of J/scale, and r in their directions.

    `step` maps a damping to the change of z·scale that minimises |r + J·dz|² + damping·|dz·scale|².
    """

    scale: np.ndarray
    singular: np.ndarray
    right: np.ndarray
    projected: np.ndarray

    def step(self, damping: float) -> np.ndarray:
        s = self.singular
        kept = s > _RANK * s[0] if damping == 0 else np.full(len(s), True)
        factor = np.where(kept, s / np.where(kept, s**2 + damping, 1.0), 0.0)
        return -self.right.T @ (factor * self.projected)

    @property
    def in_tangent(self) -> float:
        """The norm of the part of the residual that a step could take away."""
        return float(np.linalg.norm(self.projected[self.singular > _RANK * self.singular[0]]))

    def within(self, radius: float) -> tuple[np.ndarray, float]:
        """Return the step of length `radius`, or the Gauss–Newton step if that is shorter.

        The damping that belongs to the step is returned too. It is found by bisection.
        """
        step = self.step(0.0)
        if np.linalg.norm(step) <= radius:
            return step, 0.0
        low, high = 0.0, max(float(np.linalg.norm(self.singular * self.projected)) / radius, 1e-300)
        for _ in range(60):
            middle = np.sqrt(low * high) if low > 0 else high * 1e-3
            step = self.step(middle)
            length = np.linalg.norm(step)
            if abs(length - radius) <= 0.1 * radius:
                return step, middle
            low, high = (middle, high) if length > radius else (low, middle)
            if high < 1e-300:
                break
        return self.step(high), high


def levenberg_marquardt(
    residual: Residual,
    jacobian: Jacobian,
    start: np.ndarray,
    steps: int = 1000,
    reach: float = 1.0,
    worthwhile: float = 1e-15,
) -> Descent:
    """Minimise |residual(z)|² from `start` (m,).

    `residual` maps z to (n,) and `jacobian` to (n, m). A z whose residual is not finite
    is not entered, so that a function may return ∞ where z is not allowed. `steps` is the largest
    number of Jacobians. The first step may be `reach` times as long as z, in the scale of the
    Jacobian's columns. The descent ends if the linearised residual promises to lower the sum of
    squares by less than the fraction `worthwhile`; the rounding of the sum hides gains below 1e-15.
    """
    # The square of a residual that is tried may overflow: it is then not better.
    with np.errstate(over="ignore"):
        return _descend(residual, jacobian, np.asarray(start, float), steps, reach, worthwhile)


def _descend(
    residual: Residual, jacobian: Jacobian, z, steps: int, reach: float, worthwhile: float
) -> Descent:
    r = residual(z)
    if not np.isfinite(r @ r):
        return Descent(z, np.inf, False)
    scale, radius = np.zeros(len(z)), None
    for _ in range(steps):
        tangent, scale = _tangent(jacobian, z, r, scale)
        if tangent is None:
            break
        size = np.linalg.norm(r)
        if size == 0 or tangent.in_tangent**2 <= worthwhile * size**2:
            break
        if radius is None:
            radius = reach * (np.linalg.norm(scale * z) or 1.0)
        taken, radius = _take(residual, tangent, z, r, radius)
        if taken is None:
            break
        z, r = taken
    return _polished(residual, jacobian, z, r, scale, worthwhile)


def _tangent(jacobian: Jacobian, z, r, scale) -> tuple[_Tangent | None, np.ndarray]:
    """Linearise the residual; None if the Jacobian is not finite or zero. Scales never shrink."""
    matrix = jacobian(z)
    if not np.isfinite(matrix).all():
        return None, scale
    scale = np.maximum(scale, np.linalg.norm(matrix, axis=0))
    unit = np.where(scale > 0, scale, 1.0)
    q, triangle = np.linalg.qr(matrix / unit)
    left, singular, right = np.linalg.svd(triangle, full_matrices=False)
    if not singular[0] > 0:
        return None, scale
    return _Tangent(unit, singular, right, left.T @ (q.T @ r)), scale


def _take(residual: Residual, tangent: _Tangent, z, r, radius):
    """Return the new z and residual, and the next radius; None for both if no step is better."""
    size = float(np.linalg.norm(r))
    for _ in range(60):
        step, damping = tangent.within(radius)
        length = float(np.linalg.norm(step))
        trial = z + step / tangent.scale
        if np.all(trial == z):
            break
        moved = residual(trial)
        square = float(moved @ moved) if np.isfinite(moved).all() else np.inf
        # What the linearised residual promises: |r|² − |r + J·dz|².
        along = tangent.singular * (tangent.right @ step)
        promised = -float(2 * tangent.projected @ along + along @ along)
        ratio = (size**2 - square) / promised if promised > 0 else -1.0
        if ratio < 0.25:
            radius = 0.25 * length
        elif ratio > 0.75 or damping == 0:
            radius = max(radius, 2 * length)
        if ratio > _WORTHWHILE:
            return (trial, moved), radius
        if promised <= 1e-16 * size**2:
            break
    return None, radius


def _polished(residual: Residual, jacobian: Jacobian, z, r, scale, worthwhile) -> Descent:
    """Take Gauss–Newton steps while they shrink, then tell whether the end is stationary."""
    last, cosine = np.inf, np.inf
    for _ in range(_POLISHED if worthwhile <= 1e-12 else 1):
        tangent, scale = _tangent(jacobian, z, r, scale)
        if tangent is None:
            break
        size = float(np.linalg.norm(r))
        step = tangent.step(0.0)
        length = float(np.linalg.norm(step)) / (np.linalg.norm(tangent.scale * z) or 1.0)
        cosine = tangent.in_tangent / size if size else 0.0
        if not length < 0.95 * last or length > 1e-3 or length < 1e-15:
            last = min(length, last)
            break
        last = length
        trial = z + step / tangent.scale
        moved = residual(trial)
        # The sum of squares may rise by its rounding, not by more.
        if not np.linalg.norm(moved) <= size * (1 + 1e-9):
            break
        z, r = trial, moved
    norm = float(np.linalg.norm(r))
    return Descent(z, norm, bool(cosine <= CONVERGED_COSINE or last <= CONVERGED_STEP))
