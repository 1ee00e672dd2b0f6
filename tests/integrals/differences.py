"""Finite differences of fourth order, central or one-sided at the ends of a domain."""

import numpy as np

# Stencils for h f'(x): each row has the offsets k, and the weights of f(x + k h). The rows are the
# central stencil and those for the lower and the upper end.
_OFFSETS = (np.array([-2, -1, 1, 2]), np.arange(5), -np.arange(5))
_WEIGHTS = (
    np.array([1, -8, 8, -1]) / 12,
    np.array([-25, 48, -36, 16, -3]) / 12,
    -np.array([-25, 48, -36, 16, -3]) / 12,
)


def difference(function, points, axis, step, lower, upper):
    """Return the derivative of a vectorised function along `axis` at points (axes, n).

    `function` maps (axes, n) to (..., n). `step` is a scalar or an array (n,). The stencil is
    one-sided where a central one would leave [lower, upper].
    """
    points = np.asarray(points, float)
    step = np.broadcast_to(step, points.shape[1:])
    x = points[axis]
    kind = np.where(x - 2 * step < lower, 1, np.where(x + 2 * step > upper, 2, 0))
    total = 0.0
    for column in range(5):
        offsets = np.array([[*_OFFSETS[0], 0], _OFFSETS[1], _OFFSETS[2]])[kind, column]
        weights = np.array([[*_WEIGHTS[0], 0], _WEIGHTS[1], _WEIGHTS[2]])[kind, column]
        moved = points.copy()
        moved[axis] = x + offsets * step
        total = total + weights * np.asarray(function(moved))
    return total / step
