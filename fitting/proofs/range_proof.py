"""Bounds of a form's values: the integrals are fractions, and so should be what stands for them."""

import numpy as np

from fitting.form import Form, as_program, box_of, constant, traced
from fitting.points.scattered import spread_points
from fitting.proofs.pole_proof import NOWHERE_NEGATIVE, within
from programs.bounding.branch_and_bound import Bounds, bound_output

# Bounds are within this of values that are attained.
TIGHTNESS = 1e-3
# Bounds are rounded outwards at each step: a form that is one somewhere has a bound above it.
ROUNDING = 1e-12
FRACTIONS = (-ROUNDING, 1 + ROUNDING)
# log₂ of the number of points that are tried first: a form that leaves [0, 1] often does so there.
PROBES = 12


def certify_range(form: Form, tightness: float = TIGHTNESS) -> Bounds | None:
    """Prove that all values of a form lie between 0 and 1; None where that is not shown.

    Of a form that gives its margins these are shown not to be negative; the bounds are 0 and 1. Of
    others the values are bounded, to within `tightness` of what is attained. The form is one whose
    denominators are certified.
    """
    margins = constant(form).margins()
    if margins is None:
        points = spread_points(form.integral.name, form.axes, PROBES, PROBES)

        def settled(below, above, least, most):
            low, high = max(FRACTIONS[0], least - tightness), min(FRACTIONS[1], most + tightness)
            return (below >= low) & (above <= high)

        found = bound_output(as_program(form), box_of(form.axes), FRACTIONS, settled, points)
        return found if np.isfinite(found.lower) else None
    call, axes = margins
    count, boxes = len(call(*(axis.lower for axis in axes))), 0
    for program in (traced(form, lambda *x, k=k: call(*x)[k], axes) for k in range(count)):
        found = bound_output(program, box_of(axes), NOWHERE_NEGATIVE, within(NOWHERE_NEGATIVE))
        if not np.isfinite(found.lower):
            return None
        boxes += found.boxes
    return Bounds(0.0, 1.0, boxes)
