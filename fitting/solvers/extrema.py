"""Where the error of a form is largest: a search for its local maxima."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from fitting.errors import HillClimbing, climb
from integrals.reference import Axis

Size = Callable[[np.ndarray], np.ndarray]

# On a line, the error is first evaluated at so many points that are distributed as the axis says,
# at so many that are denser at both ends, and at distances from both ends that are halved so often.
_NODES, _NEAR_ENDS = 512, 48
# Then intervals are halved in rounds, if the error changes in them by more than this part of the
# largest error, until this number of points is reached.
_CHANGE, _HALVINGS, _MOST = 0.1, 30, 8000
# Local maxima above this part of the largest are refined. In each round, the interval around one is
# divided into `_PIECES` and replaced by two of these. The exact values of a round are evaluated at
# once, because a reference may need as long for one point as for thousands.
_LARGE, _REFINEMENTS, _PIECES = 0.5, 3, 16
# Over two axes, hill climbing starts in this number of cells an axis, so that it finds most maxima.
_climb_on_plane = HillClimbing(cells=12)


def worst_points(
    size: Size,
    points: np.ndarray,
    sizes: np.ndarray,
    axes: tuple[Axis, ...],
    seed: int,
    steps: int | None = None,
) -> np.ndarray:
    """Return points (m, axes) at local maxima of an absolute error.

    `size` maps points (k, axes) to absolute errors (k,); `sizes` (n,) are its values at `points`
    (n, axes). Over one axis all maxima are found that a fine, adaptive set of points shows. Over
    more axes hill climbing starts at the worst point of each cell of the domain. `steps` limits the
    points of a round of it; None for the usual limit.
    """
    if len(axes) == 1:
        return _on_line(size, axes[0])[:, None]
    search = _climb_on_plane if len(axes) == 2 else climb
    if steps is not None:
        search = replace(search, steps=steps)
    return search(size, points, sizes, axes, seed)


def _on_line(size: Size, axis: Axis) -> np.ndarray:
    even = np.linspace(0, 1, _NODES + 1)
    width = axis.upper - axis.lower
    ends = axis.lower + width * np.sin(np.pi / 2 * even) ** 2
    near = width * 0.5 ** np.arange(2, _NEAR_ENDS)
    x = np.concatenate([axis.place(even), ends, axis.lower + near, axis.upper - near])
    x = np.unique(np.clip(x, axis.lower, axis.upper)).astype(float)
    y = size(x[:, None])
    for _ in range(_HALVINGS):
        large = np.max(y[np.isfinite(y)], initial=0.0)
        halved = (np.abs(np.diff(y)) > _CHANGE * large) & (np.diff(x) > 1e-15 * width)
        middle = x[:-1][halved] + np.diff(x)[halved] / 2
        if not len(middle) or len(x) + len(middle) > _MOST:
            break
        x, y = np.append(x, middle), np.append(y, size(middle[:, None]))
        order = np.argsort(x)
        x, y = x[order], y[order]
    padded = np.concatenate([[-np.inf], y, [-np.inf]])
    # Of neighbours with equal errors, the first is taken.
    top = (y > padded[:-2]) & (y >= padded[2:]) & (y >= _LARGE * np.max(y))
    place = np.nonzero(top)[0]
    low, high = x[np.maximum(place - 1, 0)], x[np.minimum(place + 1, len(x) - 1)]
    best, value = x[place], y[place]
    for _ in range(_REFINEMENTS):
        tried = low[:, None] + (high - low)[:, None] * np.linspace(0, 1, _PIECES + 1)
        tried = np.clip(np.column_stack([tried, best]), axis.lower, axis.upper)
        found = size(tried.reshape(-1, 1)).reshape(tried.shape)
        at = np.argmax(found, axis=1)
        better = found[np.arange(len(at)), at] > value
        best = np.where(better, tried[np.arange(len(at)), at], best)
        value = np.maximum(value, found.max(axis=1))
        piece = (high - low) / _PIECES
        low, high = np.maximum(best - piece, axis.lower), np.minimum(best + piece, axis.upper)
    return best
