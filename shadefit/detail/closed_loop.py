"""BC1 blocks of a source that are chosen for the composed result, not for the source.

An encoder that sees the source only minimises the error of the source. Here each block minimises
Σ (f(ŝ, d) − t)², where ŝ are the source's texels as they are decoded. Endpoints are moved by least
squares that are linear about the present ŝ, so that f's slopes in s are the weights. Then each
endpoint is searched one code up and down. Both keep a block only if its error became smaller.
"""

from collections.abc import Callable, Iterator
from itertools import product

import numpy as np
from jaxtyping import Float, Integer

from shadefit.detail.operators import Operator
from shadefit.images.bc1 import LARGEST, encode_bc1, endpoints_of, palette, pixels_of

# More rounds improve the result by less than 0.5 %.
ROUNDS = 2
# Blocks that are worked on together; this bounds the memory.
_BATCH = 4096
# Both endpoints one code up or down
_NEIGHBOURS = np.array(list(product((-1, 0, 1), repeat=2)))
# Added to the diagonal of the least squares, whose entries are sums of squared slopes. It keeps
# endpoints that no texel uses where they are.
_DAMPING = 1e-4

# By how much of the sources' range the endpoints of a start are below and above it: all four
# colours are used, three, and the two between the endpoints
_RANGES = ((0, 0), (0.5, 0), (0, 0.5), (1, 1))

Blocks = Float[np.ndarray, "n 16 3"]
Endpoints = Integer[np.ndarray, "n 2 3"]
Places = Integer[np.ndarray, "n 16"]


def closed_loop(
    target: Blocks,
    detail: Blocks,
    operator: Operator,
    advance: Callable[[], None] | None = None,
    rounds: int = ROUNDS,
) -> tuple[Endpoints, Places]:
    """Return endpoints and places of blocks ŝ, so that f(ŝ, detail) is near the target.

    `target` and `detail` are in [0, 1]. `advance` is called after each batch of `batches(n)`.
    """
    endpoints = np.empty((len(target), 2, 3), int)
    places = np.empty((len(target), 16), int)
    for part in batches(len(target)):
        endpoints[part], places[part] = _best(target[part], detail[part], operator, rounds)
        if advance is not None:
            advance()
    return endpoints, places


def batches(count: int) -> Iterator[slice]:
    """Return the parts in which this number of blocks is worked on."""
    return (slice(first, min(first + _BATCH, count)) for first in range(0, count, _BATCH))


def _best(
    target: Blocks, detail: Blocks, operator: Operator, rounds: int
) -> tuple[Endpoints, Places]:
    """Return the blocks with the least error over all starts."""
    best = None
    for start in _starts(target, detail, operator):
        ends, places, errors = _refined(start, target, detail, operator, rounds)
        if best is None:
            best = ends, places, errors
        else:
            better = errors < best[2]
            for kept, new in zip(best, (ends, places, errors), strict=True):
                kept[better] = new[better]
    assert best is not None
    return best[0], best[1]


def _starts(target: Blocks, detail: Blocks, operator: Operator) -> Iterator[Endpoints]:
    """Return endpoints to start from.

    The first are those of an encoder that sees the source only, so that the result is not worse.
    The others are on the longest axis of the sources, which count by their squared slopes: their
    ends, and ends that are further out, so that fewer of the four colours are used.
    """
    source = operator.source(target, detail)
    yield endpoints_of(encode_bc1(pixels_of(source, 4 * len(source), 4)))
    weight = (operator.slope(source, detail) ** 2).sum(2, keepdims=True) + 1e-6
    mean = (weight * source).sum(1, keepdims=True) / weight.sum(1, keepdims=True)
    apart = source - mean
    axis = np.linalg.eigh(np.einsum("nik,nil->nkl", weight * apart, apart))[1][:, None, :, -1]
    along = (apart * axis).sum(2)
    low, high = along.min(1), along.max(1)
    for below, above in _RANGES:
        ends = np.stack([low - below * (high - low), high + above * (high - low)], axis=1)
        yield _codes(mean + ends[:, :, None] * axis)


def _codes(colours: np.ndarray) -> Endpoints:
    """Return the nearest endpoints of colours in [0, 1]."""
    return np.floor(np.clip(colours, 0, 1) * LARGEST + 0.5).astype(int)


def _refined(
    ends: Endpoints, target: Blocks, detail: Blocks, operator: Operator, rounds: int
) -> tuple[Endpoints, Places, np.ndarray]:
    ends = ends.copy()
    places, errors = _placed(ends, target, detail, operator)
    for _ in range(rounds):
        for move in (_least_squares, _neighbours):
            moved = move(ends, places, target, detail, operator)
            new_places, new_errors = _placed(moved, target, detail, operator)
            better = new_errors < errors
            ends[better], places[better] = moved[better], new_places[better]
            errors = np.where(better, new_errors, errors)
    return ends, places, errors


def _placed(
    ends: Endpoints, target: Blocks, detail: Blocks, operator: Operator
) -> tuple[Places, np.ndarray]:
    """Return the best place of each texel, and the error of each block."""
    source = palette(ends)[:, :, None, :] / 255
    composed = operator.blend(source, detail[:, None])
    errors = ((composed - target[:, None]) ** 2).sum(3)
    places = errors.argmin(1)
    return places, errors.min(1).sum(1)


def _least_squares(
    ends: Endpoints, places: Places, target: Blocks, detail: Blocks, operator: Operator
) -> Endpoints:
    """Return endpoints that minimise the error for fixed places, if f were linear about ŝ."""
    colours = palette(ends) / 255
    source = np.take_along_axis(colours, places[:, :, None], axis=1)
    wanted = target - operator.blend(source, detail)
    slope = operator.slope(source, detail)
    second = slope * (places / 3)[:, :, None]
    first = slope - second
    a00, a11 = (_DAMPING + (each * each).sum(1) for each in (first, second))
    a01 = (first * second).sum(1)
    b0, b1 = ((each * wanted).sum(1) for each in (first, second))
    determinant = a00 * a11 - a01 * a01
    change = np.stack([a11 * b0 - a01 * b1, a00 * b1 - a01 * b0], axis=1)
    return _codes(colours[:, [0, 3]] + change / determinant[:, None])


def _neighbours(
    ends: Endpoints, places: Places, target: Blocks, detail: Blocks, operator: Operator
) -> Endpoints:
    """Return the best endpoints up to one code away for fixed places, channel by channel."""
    tried = np.clip(ends[:, None] + _NEIGHBOURS[:, :, None], 0, LARGEST)
    colours = palette(tried) / 255
    source = np.take_along_axis(colours, places[:, None, :, None], axis=2)
    composed = operator.blend(source, detail[:, None])
    errors = ((composed - target[:, None]) ** 2).sum(2)
    best = errors.argmin(1)
    return np.take_along_axis(tried, best[:, None, None, :], axis=1)[:, 0]
