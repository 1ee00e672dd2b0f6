"""MaterialX's constants: the code that they are from, and how good they are."""

import functools

import jax
import numpy as np
import pytest

from coefficients.catalogue import resolve
from fitting import form_values
from integrals.microfacet import fresnel_split

# The nodes of the audit: midpoints of a grid of so many cells in μ and in √α.
CELLS = 64


def analytic(x, y):
    """Return A and B as MaterialX's code has them, where x is NdotV and y is alpha."""
    one = np.ones_like(x)
    terms = np.stack([one, x, y, x * y, x * x, y * y, x * x * y, x * y * y, x * x * y * y])
    r = np.array([
        [0.1003, -0.6303, 9.748, -2.038, 29.34, -8.245, -26.44, 19.99, -5.448],
        [0.9345, -2.323, 2.229, -3.748, 1.424, -0.7684, 1.436, 0.2913, 0.6286],
        [1.0, -1.765, 8.263, 11.53, 28.96, -7.507, -36.11, 15.86, 33.37],
        [1.0, 0.2281, 15.94, -55.83, 13.08, 41.26, 54.9, 300.2, -285.1],
    ]) @ terms  # fmt: skip
    return np.clip(r[0] / r[2], 0, 1), np.clip(r[1] / r[3], 0, 1)


def points(cells: int) -> np.ndarray:
    middle = (np.arange(cells) + 0.5) / cells
    mu, root = np.meshgrid(middle, middle, indexing="ij")
    return np.stack([mu.ravel(), root.ravel() ** 2], axis=1)


@functools.cache
def exact() -> tuple[np.ndarray, np.ndarray]:
    """Return A and B at the audit's nodes, some of which have an α below that of the tables."""

    @jax.jit
    def both(x):
        found = jax.vmap(lambda p: fresnel_split(p[0], p[1], nodes=48, azimuths=64))(x)
        return found.scale.value, found.offset.value

    parts = [both(some) for some in np.split(points(CELLS), 16)]
    return tuple(np.concatenate([np.asarray(each[k]) for each in parts]) for k in (0, 1))


def test_the_published_tables_are_the_code_of_materialx():
    at = points(9)
    a, b = analytic(*at.T)
    for name, expected in (("ggx-scale", a), ("ggx-bias", b), ("ggx-directional-albedo", a + b)):
        entry = resolve(f"published/{name}")
        # The quotients are clamped where they are exported, and in E.
        values = form_values(entry.require_fitted(), at)
        values = values if name == "ggx-directional-albedo" else np.clip(values, 0, 1)
        np.testing.assert_allclose(values, expected, atol=1e-14)
        assert "MaterialX" in entry.require_table().publication.source


def test_the_constants_of_e_are_those_of_a_and_b():
    a, b, e = (
        resolve(f"published/{name}").require_table().coefficients
        for name in ("ggx-scale", "ggx-bias", "ggx-directional-albedo")
    )
    assert e == [*a, *b]


@pytest.mark.parametrize(
    ("part", "rms", "most"),
    [("A", 1.3e-2, None), ("B", 3.4e-3, 5.0e-2), ("E", 1.25e-2, 0.102)],
)
def test_its_errors_on_a_grid_of_perceptual_roughness(part, rms, most):
    """Figures of two digits, from a computation with other nodes and other code."""
    a, b = exact()
    found_a, found_b = analytic(*points(CELLS).T)
    error = {"A": found_a - a, "B": found_b - b, "E": found_a + found_b - a - b}[part]
    assert np.sqrt(np.mean(error**2)) == pytest.approx(rms, rel=0.04)
    if most is not None:
        assert np.abs(error).max() == pytest.approx(most, rel=0.02)


def test_it_creates_energy():
    assert 1.01 < np.add(*analytic(*points(CELLS).T)).max() < 1.02
