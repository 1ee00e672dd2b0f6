"""The proof that a form's values are in the codomain of the quantity: [0, 1] for a fraction."""

import numpy as np

from fitting.form import FittedForm, traced
from fitting.points.scattered import scattered_points
from fitting.proofs.pole_proof import proof_axes
from integrals.reference import box_of
from programs.bounding.branch_and_bound import Bounds, BranchAndBound
from programs.bounding.denominators import NOWHERE_NEGATIVE, within

# The bounds are at most this far from values that the form attains.
TIGHTNESS = 1e-3
# Interval arithmetic rounds outwards in every step, so that the bound of a form that attains an end
# of the codomain is slightly outside. This part of the codomain's width is accepted.
ROUNDING = 1e-12
# The form is first evaluated at 2^PROBES points and half as many near the boundary. If a value is
# outside the codomain, no proof is attempted.
PROBES = 12


def certify_range(fitted: FittedForm, tightness: float = TIGHTNESS) -> Bounds | None:
    """Return proven bounds of a form's values within the codomain; None if there is no such proof.

    If the form has margins (`Proofs.margins`), they are proven not to be negative, and the bounds
    are the ends of the codomain. Otherwise the values are bounded by branch and bound, to within
    `tightness` of the values that the form attains. Call `certify_denominators` before: this proof
    relies on it.
    """
    form, constants = fitted.form, fitted.constants
    if form.proofs.margins is not None:
        return _by_margins(fitted)
    points = scattered_points(form.reference, form.axes, PROBES, PROBES)

    lower, upper = form.reference.codomain
    width = upper - lower
    allowed = (
        (lower - ROUNDING * width, upper + ROUNDING * width)
        if np.isfinite(width)
        else (lower, upper)
    )

    def settled(below, above, least, most):
        room = tightness * (width if np.isfinite(width) else most - least)
        low, high = max(allowed[0], least - room), min(allowed[1], most + room)
        return (below >= low) & (above <= high)

    program = traced(fitted, lambda *point: form(constants, *point), form.axes)
    solver = BranchAndBound(first_split=form.proofs.first_split)
    found = solver.bound_output(program, box_of(form.axes), allowed, settled, points)
    return found if np.isfinite(found.lower) else None


def _by_margins(fitted: FittedForm) -> Bounds | None:
    margins, constants, axes = fitted.form.proofs.margins, fitted.constants, proof_axes(fitted.form)
    assert margins is not None
    solver = BranchAndBound(first_split=fitted.form.proofs.first_split)
    count, boxes = len(margins(constants, *(axis.lower for axis in axes))), 0
    for k in range(count):
        program = traced(fitted, lambda *point, k=k: margins(constants, *point)[k], axes)
        found = solver.bound_output(
            program, box_of(axes), NOWHERE_NEGATIVE, within(NOWHERE_NEGATIVE)
        )
        if not np.isfinite(found.lower):
            return None
        boxes += found.boxes
    return Bounds(*fitted.reference.codomain, boxes)
