"""Maps of lobes as arrays: SGGX matrices of all texels, and back to normals and roughness.

`normals` are unit vectors (…, 3) with positive z. `roughness` (…, 3) has A_xx, A_xy and A_yy of
each texel, in the frame of its normal. `matrices` (…, 6) have the elements xx, xy, xz, yy, yz, zz
of S. `shading.maps` has the same formulas for one texel.
"""

import numpy as np
from jaxtyping import Float

Normals = Float[np.ndarray, "*shape 3"]
Roughness = Float[np.ndarray, "*shape 3"]
Matrices = Float[np.ndarray, "*shape 6"]
# Below this, relative to the largest element, S minus an eigenvalue is taken to be zero.
_TINY = 1e-13


def lobe_matrices(normals: Normals, roughness: Roughness) -> Matrices:
    """Return the SGGX matrices of lobes: M [A 0; 0 1] Mᵀ with the frame M of each normal."""
    x, y, z = (normals[..., k] for k in range(3))
    xx, xy, yy = (roughness[..., k] for k in range(3))
    over = 1 / (1 + z)
    cross = -x * y * over
    t = (z + y * y * over, cross, -x)
    b = (cross, z + x * x * over, -y)
    n = (x, y, z)
    # A tᵀ and so on: the rows of [A 0; 0 1] Mᵀ
    first = [xx * t[k] + xy * b[k] for k in range(3)]
    second = [xy * t[k] + yy * b[k] for k in range(3)]
    result = np.empty((*x.shape, 6), dtype=np.result_type(normals, roughness))
    for index, (i, j) in enumerate(((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))):
        result[..., index] = t[i] * first[j] + b[i] * second[j] + n[i] * n[j]
    return result


def lobes_of_matrices(matrices: Matrices) -> tuple[Normals, Roughness]:
    """Return the normals and roughness of SGGX matrices, which may have any positive factor.

    The normal is the eigenvector nearest to k. Widths are limited to 1.
    """
    scale = matrices[..., 0] + matrices[..., 3] + matrices[..., 5]
    xx, xy, xz, yy, yz, zz = (matrices[..., k] / scale for k in range(6))
    normals = _normals(xx, xy, xz, yy, yz, zz)
    x, y, z = (normals[..., k] for k in range(3))
    over = 1 / (1 + z)
    cross = -x * y * over
    t = (z + y * y * over, cross, -x)
    b = (cross, z + x * x * over, -y)
    rows = ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz))

    def form(p, q):
        return sum(
            p[i] * (rows[i][0] * q[0] + rows[i][1] * q[1] + rows[i][2] * q[2]) for i in range(3)
        )

    along = form((x, y, z), (x, y, z))
    local = [form(t, t), form(t, b), form(b, b)]
    return normals, limited(np.stack([each / along for each in local], axis=-1))


def limited(roughness: Roughness) -> Roughness:
    """Return the roughness with both widths at most 1, and the same axes. None is changed else."""
    xx, xy, yy = (roughness[..., k] for k in range(3))
    middle, difference = (xx + yy) / 2, (xx - yy) / 2
    half = np.sqrt(difference * difference + xy * xy)
    along, across = middle + half, middle - half
    wide = along > 1
    if not np.any(wide):
        return roughness
    new_along, new_across = np.minimum(along, 1), np.minimum(across, 1)
    ratio = np.where(half > 0, (new_along - new_across) / np.where(half > 0, 2 * half, 1), 1)
    middle = (new_along + new_across) / 2
    result = np.stack([middle + ratio * difference, ratio * xy, middle - ratio * difference], -1)
    return np.where(wide[..., None], result, roughness)


def slope_moments(matrices: Matrices) -> tuple[np.ndarray, np.ndarray]:
    """Return the centres μ (…, 2) and matrices Â (…, 3) of the lobes' slopes; Â is xx, xy, yy.

    S/S₃₃ = [[Â + μμᵀ, μ], [μᵀ, 1]].
    """
    scale = matrices[..., 5]
    x, y = matrices[..., 2] / scale, matrices[..., 4] / scale
    spread = [matrices[..., k] / scale for k in (0, 1, 3)]
    spread = np.stack([spread[0] - x * x, spread[1] - x * y, spread[2] - y * y], axis=-1)
    return np.stack([x, y], axis=-1), spread


def matrices_of_slopes(mean: np.ndarray, spread: np.ndarray) -> Matrices:
    """Return the matrices S/S₃₃ (…, 6) of centres (…, 2) and matrices (…, 3) of slopes."""
    x, y = mean[..., 0], mean[..., 1]
    xx, xy, yy = (spread[..., k] for k in range(3))
    return np.stack([xx + x * x, xy + x * y, x, yy + y * y, y, np.ones_like(x)], axis=-1)


def _normals(xx, xy, xz, yy, yz, zz) -> Normals:
    """Return the axes that are the normals of SGGX matrices with the trace 1.

    The eigenvalues come from the trigonometric formula. The eigenvector is the largest product of
    two rows of S − λ. One step of inverse iteration would not add digits: those of λ are enough.
    """
    third = 1 / 3
    a, b, c = xx - third, yy - third, zz - third
    p2 = (a * a + b * b + c * c + 2 * (xy * xy + xz * xz + yz * yz)) / 6
    p = np.sqrt(np.maximum(p2, 0))
    det = a * (b * c - yz * yz) - xy * (xy * c - yz * xz) + xz * (xy * yz - b * xz)
    with np.errstate(divide="ignore", invalid="ignore"):
        r = np.where(p > 0, det / (2 * p * p2), 1.0)
    angle = np.arccos(np.clip(r, -1, 1)) / 3
    largest = third + 2 * p * np.cos(angle)
    normals = _eigenvectors(xx, xy, xz, yy, yz, zz, largest)
    # The normal is the axis with the largest part λ z² of S₃₃ = Σ λ z².
    steep = largest * normals[..., 2] ** 2 < zz / 2
    if np.any(steep):
        chosen = [each[steep] for each in (xx, xy, xz, yy, yz, zz)]
        matrices = np.empty((*chosen[0].shape, 3, 3))
        for index, (i, j) in enumerate(((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))):
            matrices[..., i, j] = matrices[..., j, i] = chosen[index]
        values, vectors = np.linalg.eigh(matrices)
        best = np.argmax(values * vectors[:, 2, :] ** 2, axis=-1)
        found = vectors[np.arange(len(best)), :, best]
        normals[steep] = np.where(found[:, 2:] < 0, -found, found)
    return normals


def _eigenvectors(xx, xy, xz, yy, yz, zz, value) -> Normals:
    """Return the unit eigenvectors of an eigenvalue, with positive z; k if S is that times 1."""
    a, b, c = xx - value, yy - value, zz - value
    products = (
        (xy * yz - xz * b, xz * xy - a * yz, a * b - xy * xy),
        (xy * c - xz * yz, xz * xz - a * c, a * yz - xz * xy),
        (b * c - yz * yz, yz * xz - xy * c, xy * yz - b * xz),
    )
    squares = [x * x + y * y + z * z for x, y, z in products]
    best, length = list(products[0]), squares[0]
    for each, square in zip(products[1:], squares[1:], strict=True):
        larger = square > length
        length = np.where(larger, square, length)
        best = [np.where(larger, new, old) for new, old in zip(each, best, strict=True)]
    vanishing = length <= _TINY**2
    root = np.sqrt(np.where(vanishing, 1, length)) * np.where(best[2] < 0, -1, 1)
    result = np.stack([each / root for each in best], axis=-1)
    result[vanishing] = (0, 0, 1)
    return result
