"""What the tests of microfacet samplers share: settings, densities, and the chi-square test."""

import jax
import numpy as np
from scipy.stats import chi2

from shading.microfacet.sampling import (
    projected_areas,
    sample_bounded_cap,
    sample_cap,
    sample_disk,
    sample_upper,
)


def view_of(theta: float, phi: float) -> np.ndarray:
    """Return the unit vector (3,) of the polar angle and the azimuth, both in degrees."""
    theta, phi = np.radians([theta, phi])
    return np.array([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)])


# Of each sampler: the function for arrays, the field of its N in `ProjectedAreas`, and how many
# random numbers it takes.
SAMPLERS = {
    name: (jax.jit(jax.vmap(function, (None, None, 0))), field, numbers)
    for name, function, field, numbers in (
        ("disk", sample_disk, "visible", 2),
        ("cap", sample_cap, "visible", 2),
        ("bounded cap", sample_bounded_cap, "bounded", 2),
        ("upper", sample_upper, "upper", 3),
    )
}
areas = jax.jit(projected_areas)


def drawn(name: str, view, alphas, numbers) -> np.ndarray:
    """Return lights (n, 3) of a sampler for one setting and random numbers (n, 2 or 3)."""
    kind = numbers.dtype
    return np.asarray(SAMPLERS[name][0](np.asarray(view, kind), np.asarray(alphas, kind), numbers))


def distribution(half: np.ndarray, alphas) -> np.ndarray:
    """Return D of normals (…, 3) of any length but zero, from the definition of GGX."""
    unit = half / np.linalg.norm(half, axis=-1, keepdims=True)
    squares = (unit / np.array([*alphas, 1.0])) ** 2
    return 1 / (np.pi * np.prod(alphas) * squares.sum(axis=-1) ** 2)


ROWS, COLUMNS = 16, 24


def p_value(lights, view, alphas, area, lowest: float) -> float:
    """Return the p-value of lights (n, 3) for the density D(h)/(4N), N = `area`, by chi-square.

    The cells are 16 in cos θ from `lowest` to 1 by 24 in azimuth. The expected counts are integrals
    by 16² Gauss points. All else is counted as one cell more: lights below `lowest`, and cells
    where 12² points give another count. These are at i = −o, where the density has no limit.
    """
    total = len(lights)
    expected, coarse = (total * _of_cells(nodes, view, alphas, area, lowest) for nodes in (16, 12))
    seen = lights[lights[:, 2] > lowest]
    counts, _, _ = np.histogram2d(
        seen[:, 2],
        np.arctan2(seen[:, 1], seen[:, 0]),
        [np.linspace(lowest, 1, ROWS + 1), np.linspace(-np.pi, np.pi, COLUMNS + 1)],
    )
    good = abs(expected - coarse) < 0.1 * np.sqrt(expected)
    assert good.sum() > 0.9 * good.size
    expected, counts = expected[good], counts[good]
    expected = np.append(expected, max(0.0, total - expected.sum()))
    counts = np.append(counts, total - counts.sum())
    full = expected > 10
    statistic = np.sum((counts[full] - expected[full]) ** 2 / expected[full])
    return float(chi2.sf(statistic, full.sum() - 1))


def _of_cells(nodes: int, view, alphas, area: float, lowest: float) -> np.ndarray:
    """Return the probabilities (rows, columns) of the cells by Gauss rules of nodes² points."""
    x, weights = np.polynomial.legendre.leggauss(nodes)
    x, weights = (x + 1) / 2, weights / 2
    height = lowest + (1 - lowest) * ((np.arange(ROWS)[:, None] + x) / ROWS).ravel()
    azimuth = ((np.arange(COLUMNS)[:, None] + x) / COLUMNS).ravel() * 2 * np.pi - np.pi
    z, phi = np.meshgrid(height, azimuth, indexing="ij")
    level = np.sqrt(1 - z * z)
    at = np.stack([level * np.cos(phi), level * np.sin(phi), z], axis=-1)
    density = distribution(at + view, alphas) / (4 * area)
    cells = density.reshape(ROWS, nodes, COLUMNS, nodes)
    size = (1 - lowest) * 2 * np.pi / ROWS / COLUMNS
    return np.einsum("aibj,i,j->ab", cells, weights, weights) * size
