"""The random walk of light on Smith's microsurface, which scatters as often as it does.

A ray starts above the surface. Its next collision is drawn from Smith's masking at its height, the
facet from the normals that the ray sees, and it is reflected there, until it leaves. This is the
model of E. Heitz, J. Hanika, E. d'Eon and C. Dachsbacher, Multiple-Scattering Microfacet BSDFs with
the Smith Model, 2016, with uniform heights. The heights' distribution does not matter: the walk
depends on the height h only by C(h), the part of the surface below it, and C is uniform here.

The rays that leave after one reflection make up E with the height-correlated masking, and with
F = 1 all rays leave. So the walk is an independent method for E, and it says how much light an
approximation of multiple scattering should return. It is NumPy code: paths have different lengths.
"""

from collections.abc import Callable
from typing import NamedTuple

import jax.numpy as jnp
import numpy as np

from integrals.reference import Estimate
from shading.types import Scalar

# A path that has not left after this many reflections is dropped.
MOST_REFLECTIONS = 100
_CHUNK = 1 << 16

Reflectance = Callable[[np.ndarray], np.ndarray]


class Walk(NamedTuple):
    """What leaves a surface, for each reflectance: after one reflection, after more, and all."""

    first: Estimate
    multiple: Estimate
    total: Estimate


def white(cosine: np.ndarray) -> np.ndarray:
    """Return a reflectance of one."""
    return np.ones((len(cosine), 1))


def schlick(*normal_reflectances: float) -> Reflectance:
    """Return F0 + (1 − F0)(1 − x)⁵, Schlick's reflectance, for several F0 at once."""
    least = np.asarray(normal_reflectances)

    def reflectance(cosine: np.ndarray) -> np.ndarray:
        return least + (1 - least) * ((1 - cosine) ** 5)[:, None]

    return reflectance


def walk(
    view: np.ndarray,
    alpha: Scalar | np.ndarray,
    *,
    reflectance: Reflectance = white,
    paths: int = 1 << 16,
    seed: int = 0,
) -> Walk:
    """Follow `paths` rays that arrive from the unit vector `view` (3,), and return what leaves.

    `alpha` is α or (αx, αy). `reflectance` maps the cosines x = i·m of (n,) reflections to (n, k)
    numbers in [0, 1], one for each of k materials that are walked at once. Returns estimates (k,)
    with standard errors. Raises ValueError for a view that is not above the horizon, for α ≤ 0, and
    for fewer than two paths.
    """
    view, widths = np.asarray(view, float), np.broadcast_to(np.asarray(alpha, float), (2,))
    if not view[2] > 0:
        raise ValueError(f"view = {view.tolist()}: its z must be positive")
    if not np.all(widths > 0):
        raise ValueError(f"alpha = {np.asarray(alpha).tolist()}: it must be positive")
    if paths < 2:
        raise ValueError(f"paths = {paths}: at least 2 are needed for a standard error")
    rng = np.random.default_rng(seed)
    sums = []
    for start in range(0, paths, _CHUNK):
        first, total = _follow(view, widths, reflectance, min(_CHUNK, paths - start), rng)
        sums.append([(x.sum(axis=0), (x * x).sum(axis=0)) for x in (first, total - first, total)])
    added = np.sum(sums, axis=0)
    mean = added[:, 0] / paths
    error = np.sqrt(np.maximum(added[:, 1] / paths - mean * mean, 0) / (paths - 1))
    return Walk(
        *(Estimate(jnp.asarray(m), jnp.asarray(e)) for m, e in zip(mean, error, strict=True))
    )


def _follow(
    view, widths, reflectance: Reflectance, count: int, rng
) -> tuple[np.ndarray, np.ndarray]:
    """Return the energy of each path that left after one reflection, and after any number."""
    ray = np.tile(-view, (count, 1))
    below = np.ones(count)  # C(h): the part of the surface below the ray's height
    energy = np.ones((count, reflectance(np.ones(1)).shape[1]))
    first, total = np.zeros_like(energy), np.zeros_like(energy)
    path = np.arange(count)
    for reflections in range(MOST_REFLECTIONS + 1):
        below, stays = _next_height(ray, below, widths, rng)
        left = path[~stays]
        if reflections == 1:
            first[left] = energy[~stays]
        total[left] = energy[~stays]
        ray, below, energy, path = ray[stays], below[stays], energy[stays], path[stays]
        if not len(path):
            break
        back = -ray
        normal = _visible_normals(back, widths, rng)
        cosine = np.clip(np.sum(back * normal, axis=1), 0.0, 1.0)
        energy = energy * reflectance(cosine)
        ray = 2 * cosine[:, None] * normal - back
    return first, total


def _next_height(ray, below, widths, rng) -> tuple[np.ndarray, np.ndarray]:
    """Return C at the next collision of each ray, and whether there is one."""
    sigma = np.sqrt(np.sum((ray[:, :2] * widths) ** 2, axis=1) + ray[:, 2] ** 2)
    cosine = np.where(ray[:, 2] == 0, 1e-300, ray[:, 2])
    # Λ of the ray: positive for rays that rise, at most −1 for those that descend. A ray along the
    # normal has Λ = 0 or −1.
    masked = np.where(cosine > 0, (sigma - cosine) / (2 * cosine), (sigma / cosine - 1) / 2)
    masked = np.where(masked == 0, 1e-300, masked)
    free = -np.log1p(-rng.random(len(ray)))  # exponential: optical distance to the collision
    with np.errstate(over="ignore"):
        reached = below * np.exp(np.minimum(free / masked, 700.0))
    return reached, reached < 1


def _visible_normals(back, widths, rng) -> np.ndarray:
    """Draw normals that the unit vectors `back` (n, 3) see, by spherical caps.

    J. Dupuy and A. Benyoub, Sampling Visible GGX Normals with Spherical Caps, 2023.
    """
    stretched = back * np.append(widths, 1.0)
    stretched /= np.linalg.norm(stretched, axis=1, keepdims=True)
    u = rng.random((2, len(back)))
    z = (1 - u[0]) * (1 + stretched[:, 2]) - stretched[:, 2]
    radius = np.sqrt(np.clip(1 - z * z, 0.0, 1.0))
    angle = 2 * np.pi * u[1]
    normal = np.stack([radius * np.cos(angle), radius * np.sin(angle), z], axis=1) + stretched
    normal *= np.append(widths, 1.0)
    return normal / np.linalg.norm(normal, axis=1, keepdims=True)
