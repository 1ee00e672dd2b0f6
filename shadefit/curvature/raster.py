"""An orthographic rasteriser of triangles: which triangle each pixel shows, and where in it."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

# Pairs of a triangle and a pixel that are looked at together; a larger triangle is alone.
_PAIRS = 1 << 20


@dataclass(frozen=True)
class Raster:
    """What pixels show: the number of a triangle or −1, and the weights of its corners.

    Rows of the image go downwards.
    """

    triangles: Int[np.ndarray, "h w"]
    weights: Float[np.ndarray, "h w 3"]

    @property
    def covered(self) -> np.ndarray:
        """Whether a pixel shows a triangle, (h, w)."""
        return self.triangles >= 0

    def corners(self, triangles: Int[np.ndarray, "m 3"]) -> tuple[np.ndarray, np.ndarray]:
        """Return vertices (p, 3) and weights (p, 3) of the corners at the covered pixels."""
        return triangles[self.triangles[self.covered]], self.weights[self.covered]


def rasterise(
    places: Float[np.ndarray, "n 3"], triangles: Int[np.ndarray, "m 3"], size: tuple[int, int]
) -> Raster:
    """Return the nearest triangle at the centre of each pixel of an image (height, width).

    `places` are in pixels: x to the right, y downwards from the upper left corner, and z, of which
    the largest is nearest. Both sides of a triangle are seen. Of equally near triangles, the one
    with the lowest number is taken.
    """
    height, width = size
    found = np.full(height * width, -1, np.int64)
    weights = np.zeros((height * width, 3))
    nearest = np.full(height * width, -np.inf)
    corners = places[triangles]
    # Pixels whose centres are in the bounding box
    low = np.clip(np.ceil(corners[..., :2].min(1) - 0.5), 0, [width, height]).astype(np.int64)
    high = np.clip(np.floor(corners[..., :2].max(1) + 0.5), 0, [width, height]).astype(np.int64)
    columns, lines = np.maximum(high - low, 0).T
    ends = np.cumsum(columns * lines)
    start = 0
    while start < len(triangles):
        before = ends[start - 1] if start else 0
        stop = max(start + 1, int(np.searchsorted(ends, before + _PAIRS, side="right")))
        rows = np.arange(start, stop)
        count = (columns * lines)[rows]
        own = np.repeat(rows, count)
        place = np.arange(len(own)) - np.repeat(np.cumsum(count) - count, count)
        x = low[own, 0] + place % columns[own]
        y = low[own, 1] + place // columns[own]
        at, inside = _weights(corners[own], x + 0.5, y + 0.5)
        own, pixel, at = own[inside], (y * width + x)[inside], at[inside]
        depth = np.sum(at * corners[own, :, 2], axis=1)
        order = np.lexsort((own, -depth, pixel))
        first = order[np.unique(pixel[order], return_index=True)[1]]
        first = first[depth[first] > nearest[pixel[first]]]
        nearest[pixel[first]] = depth[first]
        found[pixel[first]], weights[pixel[first]] = own[first], at[first]
        start = stop
    return Raster(found.reshape(size), weights.reshape(*size, 3))


def _weights(corners: np.ndarray, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the barycentric weights (p, 3) of points, and whether they are in their triangles."""
    apart = corners[:, :, :2] - np.stack([x, y], 1)[:, None, :]
    one, other = np.roll(apart, -1, axis=1), np.roll(apart, -2, axis=1)
    areas = one[..., 0] * other[..., 1] - one[..., 1] * other[..., 0]
    total = areas.sum(1)
    weights = areas / np.where(total == 0, 1.0, total)[:, None]
    return weights, (total != 0) & (weights >= 0).all(1)
