"""The directions in which the fibres of an image lean."""

from functools import lru_cache
from pathlib import Path
from threading import Lock

import numpy as np

from shadefit.render.scenes import Hits

EVEN, CRUSHED = "even", "crushed"
# Crushed velvet is a sum of waves: their number, their shortest and longest length in units of the
# scene, and the largest turn of a fibre in radians.
_WAVES, _SHORTEST, _LONGEST, _TURN = 24, 0.3, 1.1, 1.3
# The largest width and height of a map in pixels
_MAX_EDGE = 4096
_READING = Lock()


def azimuths(fibers: str, hits: Hits) -> np.ndarray:
    """Return the angles (n,) that turn the fibres about the normal, in radians.

    Angle 0 leaves a fibre in the direction `hits.comb`. `fibers` is one of:

    * 'even': all angles are 0.
    * 'crushed': patches with different angles.
    * the path of a PNG file. Its red and green channels map 0 … 1 to −1 … 1 and are the components
      of the fibre's direction along the comb and across it, at `hits.uv`.

    Raises ValueError for a file that is no such image.
    """
    if fibers == EVEN:
        return np.zeros(len(hits.position))
    if fibers == CRUSHED:
        return _crushed(hits.position)
    return _angles_from_map(_map_of(Path(fibers)), hits.uv)


def _crushed(position: np.ndarray) -> np.ndarray:
    """Return the angles of a smooth pattern with plateaus. The seed makes every run the same."""
    rng = np.random.default_rng(20200717)
    ways = rng.normal(size=(_WAVES, 3))
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    lengths = np.exp(rng.uniform(np.log(_SHORTEST), np.log(_LONGEST), _WAVES))
    phases, weights = rng.uniform(0, 2 * np.pi, _WAVES), lengths / np.sqrt(np.sum(lengths**2) / 2)
    waves = np.sin(position @ (2 * np.pi * ways / lengths[:, None]).T + phases)
    return _TURN * np.tanh(1.5 * (waves @ weights))


def _map_of(path: Path) -> np.ndarray:
    """Return red and green (height, width, 2) of a PNG file, read once unless it changes."""
    try:
        found = path.stat()
        state = (found.st_ino, found.st_size, found.st_mtime_ns)
    except OSError:
        # Reading says what is wrong.
        state = ()
    # Two images are drawn at a time: the second one waits for the map that the first one reads.
    with _READING:
        return _read_map(path, state)


@lru_cache(maxsize=1)
def _read_map(path: Path, state: tuple[int, ...]) -> np.ndarray:
    del state
    from shadefit.images import read_image  # noqa: PLC0415
    from shadefit.images.colour_space import LINEAR  # noqa: PLC0415

    try:
        pixels = read_image(path, LINEAR, _MAX_EDGE).pixels
    except ValueError as error:
        raise ValueError(f"fibers: {error}; allowed: {EVEN}, {CRUSHED}, or a PNG file") from None
    if pixels.shape[2] < 2:
        raise ValueError(f"fibers: {path} has no red and green channels")
    return np.ascontiguousarray(pixels[..., :2])


def _angles_from_map(pixels: np.ndarray, uv: np.ndarray) -> np.ndarray:
    """Return the angles at `uv` (n, 2) by bilinear interpolation of the map, which repeats.

    The values 0 … 1 of the map stand for −1 … 1.

    Directions are interpolated and not angles, because angles jump from π to −π.
    """
    height, width, _ = pixels.shape
    x, y = (uv[:, i] * n - 0.5 for i, n in ((0, width), (1, height)))
    left, top = np.floor(x).astype(int), np.floor(y).astype(int)
    total = np.zeros((len(x), 2))
    for i in (0, 1):
        for j in (0, 1):
            weight = np.abs(1 - i - (x - left)) * np.abs(1 - j - (y - top))
            found = pixels[(top + j) % height, (left + i) % width].astype(float)
            total += weight[:, None] * (2 * found - 1)
    return np.arctan2(total[:, 1], total[:, 0])
