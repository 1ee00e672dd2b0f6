"""Gaussian means of tensors and normals over many samples of a surface, by blocks of matrices.

The shortest rotation R of a normal m to n takes a vector v that is orthogonal to m to
v − (m + n)(n·v)/(1 + n·m). So for an axis f that is orthogonal to n,

    f·R v = (f − n (f·m)/(1 + n·m))·v,

and the entry of a tensor S of the plane of m in the axes e and f is

    e·S f − q (e·m)(n·S f) − q (f·m)(n·S e) + q² (e·m)(f·m)(n·S n),   q = 1/(1 + n·m).

Its mean over samples takes three sums, of w S, of w q m S and of w q² m m S, which do not depend on
the axes. All of them are products of a matrix of weights with a matrix of the samples.
"""

import itertools
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.spatial import KDTree

Points = Float[np.ndarray, "n 3"]
# A Gaussian is cut at this many widths.
REACH = 3.0
# The variance of what is left of a Gaussian in the plane, as a part of σ²
CUT_VARIANCE = 1 - REACH**2 / 2 / np.expm1(REACH**2 / 2)
# Points of a block, which have the samples of their weights in common, and those that are reduced
# at once
_BLOCK, _CHUNK = 64, 8192
# The place of each entry of a symmetric matrix in a row of six
_SIX = np.array([[0, 1, 2], [1, 3, 4], [2, 4, 5]])
_ROWS, _COLUMNS = np.array([0, 0, 0, 1, 1, 2]), np.array([0, 1, 2, 1, 2, 2])


@dataclass(frozen=True)
class Samples:
    """Samples of a surface: places in mm, unit normals, mean normals, matrices, and areas in mm².

    The matrices (n, 3, 3) are tensors of space in the planes of the unit normals. The mean normals
    are shorter than 1 where a sample stands for normals that differ.
    """

    places: Points
    normals: Points
    mean_normals: Points
    matrices: Float[np.ndarray, "n 3 3"]
    areas: Float[np.ndarray, " n"]


@dataclass(frozen=True)
class Sums:
    """Weighted means around points: tensors (n, 3) in their frames, normals and places.

    `mass` (n,) is the sum of the weights. Where it is zero, all means are zero.
    """

    mass: Float[np.ndarray, " n"]
    tensors: Points
    normals: Points
    places: Points


def gaussian_sums(
    samples: Samples, places: Points, frames: Float[np.ndarray, "n 2 3"], width: float
) -> Sums:
    """Return the means of samples around points, weighted by area and a Gaussian of σ = `width`.

    Samples count up to `REACH` widths, and if their normals are less than 90° from that of the
    frame. Their tensors are carried to the frame by the shortest rotation.
    """
    count = len(places)
    found = Sums(np.zeros(count), np.zeros((count, 3)), np.zeros((count, 3)), np.zeros((count, 3)))
    if not len(samples.areas):
        return found
    tree, columns = KDTree(samples.places), _columns(samples)
    waiting = blocks(places, _BLOCK)
    while chunk := tuple(itertools.islice(waiting, _CHUNK // _BLOCK)):
        rows = np.concatenate(chunk)
        normals = np.cross(frames[rows, 0], frames[rows, 1])
        sums = _chunk_sums(samples, tree, columns, places, rows, normals, chunk, width)
        mass = sums[0][:, 0]
        means = [each / np.where(mass > 0, mass, 1.0)[:, None] for each in sums]
        found.mass[rows] = mass
        found.normals[rows], found.places[rows] = means[0][:, 1:4], means[0][:, 4:7]
        found.tensors[rows] = _carried(means[0][:, 7:], means[1], means[2], frames[rows], normals)
    return found


def blocks(places: Points, size: int) -> Iterator[np.ndarray]:
    """Yield the numbers of points in groups of at most `size` that are near to each other."""
    waiting = [np.arange(len(places))]
    while waiting:
        rows = waiting.pop()
        if len(rows) <= size:
            yield rows
            continue
        axis = np.argmax(np.ptp(places[rows], axis=0))
        half = len(rows) // 2
        order = np.argpartition(places[rows, axis], half)
        waiting += [rows[order[half:]], rows[order[:half]]]


def in_plane(
    matrices: Float[np.ndarray, "n 3 3"],
    normals: Points,
    frames: Float[np.ndarray, "n 2 3"],
    frame_normals: Points,
) -> Points:
    """Return tensors (n, 3) of the planes of `normals` in frames of other planes."""
    cosine = np.sum(normals * frame_normals, axis=1)
    # Opposite normals have no shortest rotation; anything but zero will do as a divisor.
    along = np.einsum("nai,ni->na", frames, normals) / np.maximum(1 + cosine, 1e-30)[:, None]
    axes = frames - along[:, :, None] * frame_normals[:, None, :]
    bent = axes @ matrices
    return np.stack(
        [np.sum(bent[:, a] * axes[:, b], axis=1) for a, b in ((0, 0), (0, 1), (1, 1))], 1
    )


def _columns(samples: Samples) -> tuple[np.ndarray, ...]:
    """Return what is summed with the weights w, w q and w q²."""
    count, normals = len(samples.areas), samples.normals
    six = samples.matrices[:, _ROWS, _COLUMNS]
    pairs = normals[:, _ROWS] * normals[:, _COLUMNS]
    ones = np.ones((count, 1))
    return (
        np.hstack([ones, samples.mean_normals, samples.places, six]),
        (normals[:, :, None] * six[:, None, :]).reshape(count, 18),
        (pairs[:, :, None] * six[:, None, :]).reshape(count, 36),
    )


def _chunk_sums(samples, tree, columns, places, rows, normals, chunk, width) -> list[np.ndarray]:
    """Return the sums (n, …) of each of the columns at the points of a chunk of blocks."""
    sums = [np.empty((len(rows), each.shape[1])) for each in columns]
    start, reach2 = 0, (REACH * width) ** 2
    for block in chunk:
        own = slice(start, start + len(block))
        start = own.stop
        middle = (places[block].min(0) + places[block].max(0)) / 2
        here = places[block] - middle
        radius = np.sqrt(np.sum(here**2, axis=1).max())
        near = np.asarray(tree.query_ball_point(middle, REACH * width + radius), np.int64)
        there = samples.places[near] - middle
        distance2 = np.sum(here**2, 1)[:, None] + np.sum(there**2, 1) - 2 * here @ there.T
        cosine = normals[own] @ samples.normals[near].T
        weight = np.exp(distance2 * (-0.5 / width**2)) * samples.areas[near]
        weight[(distance2 > reach2) | (cosine <= 0)] = 0.0
        quotient = 1 / (1 + np.maximum(cosine, 0.0))
        for total, column in zip(sums, columns, strict=True):
            np.matmul(weight, column[near], out=total[own])
            weight *= quotient
    return sums


def _carried(plain, single, double, frames, normals) -> Points:
    """Return the tensors (n, 3) in frames of the three sums."""
    plain = plain[:, _SIX]
    single = single.reshape(-1, 3, 6)[:, :, _SIX]
    double = double.reshape(-1, 6, 6)[:, _SIX][..., _SIX]
    # n·S, n·S n: the last index of each sum is contracted with the normal.
    single_n = np.einsum("nkpq,nq->nkp", single, normals)
    double_n = np.einsum("nklpq,np,nq->nkl", double, normals, normals, optimize=True)
    mixed = np.einsum("nai,nij,nbj->nab", frames, single_n, frames, optimize=True)
    matrix = frames @ (plain + double_n) @ frames.transpose(0, 2, 1)
    whole = matrix - mixed - mixed.transpose(0, 2, 1)
    return whole[:, [0, 0, 1], [0, 1, 1]]
