"""How well the points of a fit determine its coefficients: standard errors and condition."""

from dataclasses import dataclass

import numpy as np

from fitting.form import FittedForm
from fitting.points.sample import Sample
from fitting.solvers.residuals import residuals

# Coefficients are not unique if the scaled Jacobian's condition number is above this: then rounding
# decides about their last six digits or more.
MOST_CONDITION = 1e10
# A coefficient takes part in a direction that is not determined if its component is at least this
# part of the direction's largest.
_PART = 1e-3


@dataclass(frozen=True)
class Uncertainty:
    """The standard errors of coefficients, and whether the points determine them.

    * `standard_errors` (m,): by linearisation, with the residual variance Σr²/(n − m) of n points
      and m coefficients; ∞ for a coefficient that is not determined. They describe data whose
      errors are independent. For exact values they say how sharply the fit determines a
      coefficient.
    * `condition`: the ratio of the largest to the smallest singular value of the Jacobian, with its
      columns scaled to one length; ∞ if a coefficient has no effect.
    * `unique`: whether the condition is at most `MOST_CONDITION`.
    * `worst_direction` (m,): the change of the coefficients that changes the values least, in units
      of what each coefficient alone would need for the same change. Its length is one.
    * `undetermined`: the names of the coefficients that are not determined; empty if `unique`.
    """

    standard_errors: np.ndarray
    condition: float
    unique: bool
    worst_direction: np.ndarray
    undetermined: tuple[str, ...]


def uncertainty(fitted: FittedForm, sample: Sample) -> Uncertainty:
    """Return the standard errors of a least squares fit to a sample, and its condition.

    The errors are weighted by `sample.scale`; for data with standard deviations σ it is 1/σ. Raises
    ValueError for a form without coefficients, for fewer points than coefficients plus one, and for
    a Jacobian that is not finite.
    """
    form, count = fitted.form, len(sample.exact)
    if not form.size:
        raise ValueError(f"{form.name} has no coefficients")
    if count <= form.size:
        raise ValueError(
            f"{count} points for {form.size} coefficients of {form.name}: "
            f"standard errors need at least {form.size + 1}"
        )
    free, fixed = np.full(form.size, True), np.zeros(form.size)
    problem = residuals(form, sample.points, sample.exact, sample.scale, free, fixed)
    z = fitted.constants.ravel()
    error, jacobian = problem.values(z), problem.slopes(z, np.arange(count))
    if not (np.isfinite(error).all() and np.isfinite(jacobian).all()):
        raise ValueError(f"the errors or slopes of {form.name} are not finite at all points")
    norms = np.linalg.norm(jacobian, axis=0)
    unit = np.where(norms > 0, norms, 1.0)
    triangle = np.linalg.qr(jacobian / unit, mode="r")
    _, singular, right = np.linalg.svd(triangle)
    condition = float(singular[0] / singular[-1]) if singular[-1] > 0 else np.inf
    lost = singular * MOST_CONDITION < singular[0]
    deviation = np.linalg.norm(error) / np.sqrt(count - form.size)
    inverse = right[~lost] / singular[~lost, None]
    spread = deviation * np.linalg.norm(inverse, axis=0) / unit
    parts = np.abs(right[lost])
    taking = np.any(parts >= _PART * parts.max(axis=1, keepdims=True), axis=0)
    names = np.ravel(form.coefficient_names)
    return Uncertainty(
        standard_errors=np.where(taking, np.inf, spread),
        condition=condition,
        unique=not lost.any(),
        worst_direction=right[-1],
        undetermined=tuple(str(name) for name in names[taking]),
    )
