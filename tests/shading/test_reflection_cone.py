"""The cone of upward reflections: its eigenvalue, its area, and their derivatives."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from integrals.fuzz.sggx import sggx_scattered_fraction
from shading.microfacet.reflection_cone import (
    FLOAT32_STEPS,
    FLOAT64_STEPS,
    cone_of,
    reflection_cone,
    upper_area,
)
from tests.shading.microfacets import view_of

COUNT = 20_000


def settings(highest: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return views (n, 3), and roughnesses from 1e-3 to `highest`.

    Half of the views are near grazing, and 100 near normal incidence.
    """
    rng = np.random.default_rng(3)
    grazing = 90 - 10 ** rng.uniform(-4, 2, COUNT // 2).clip(max=89)
    theta = np.concatenate([rng.uniform(0, 90, COUNT - len(grazing)), grazing])
    theta[:100] = 10 ** rng.uniform(-8, -1, 100)
    theta[0] = 0
    azimuths = rng.uniform(0, 360, COUNT)
    views = np.stack([view_of(*each) for each in zip(theta, azimuths, strict=True)])
    alpha_x, alpha_y = 10 ** rng.uniform(-3, np.log10(highest), (2, COUNT))
    return views, alpha_x, alpha_y


def matrices(views, alpha_x, alpha_y) -> np.ndarray:
    """Return C = M(o nᵀ + n oᵀ − μI)M as (n, 3, 3), from its definition."""
    normal = np.array([0.0, 0.0, 1.0])
    outer = views[:, :, None] * normal
    cone = outer + outer.transpose(0, 2, 1) - views[:, 2, None, None] * np.eye(3)
    root = np.stack([alpha_x, alpha_y, np.ones(len(views))], axis=1)
    return root[:, :, None] * cone * root[:, None, :]


def solved(steps, *given):
    def both(view, alpha_x, alpha_y):
        cone = reflection_cone(view, jnp.stack([alpha_x, alpha_y]), steps)
        return cone.eigenvalue, upper_area(cone)

    return jax.jit(jax.vmap(both))(*given)


@pytest.mark.parametrize(
    ("dtype", "highest", "steps", "tolerance"),
    [
        # The tolerances are some roundings of the type.
        (np.float64, 1.0, FLOAT64_STEPS, 1e-14),
        (np.float64, 5.0, FLOAT64_STEPS, 1e-13),
        (np.float32, 1.0, FLOAT32_STEPS, 2e-6),
        (np.float64, 1.0, FLOAT32_STEPS, 5e-7),
    ],
)
def test_eigenvalue_and_area_are_those_of_the_matrix(dtype, highest, steps, tolerance):
    views, alpha_x, alpha_y = settings(highest)
    values, vectors = np.linalg.eigh(matrices(views, alpha_x, alpha_y))
    stretched = views * np.stack([alpha_x, alpha_y, np.ones(COUNT)], axis=1)
    gaps = (values[:, 2] - values[:, 1]) * (values[:, 2] - values[:, 0])
    along = np.abs(np.sum(vectors[:, :, 2] * stretched, axis=1))
    root, area = solved(steps, *(each.astype(dtype) for each in (views, alpha_x, alpha_y)))
    assert root.dtype == dtype
    np.testing.assert_allclose(root, values[:, 2], rtol=tolerance)
    np.testing.assert_allclose(area, along * values[:, 2] / np.sqrt(gaps), rtol=tolerance)


def test_area_is_that_of_the_closed_form_of_ps():
    """σ(1 − P_s) of docs/closed-form.md, which is computed from other invariants of the matrix."""
    views, alpha_x, alpha_y = (each[:2000] for each in settings(1.0))
    alpha_x, alpha_y = np.maximum(alpha_x, 0.05), np.maximum(alpha_y, 0.05)

    def other(view, alpha_x, alpha_y):
        matrix = jnp.diag(jnp.stack([alpha_x**2, alpha_y**2, jnp.ones(())]))
        return jnp.sqrt(view @ matrix @ view) * (1 - sggx_scattered_fraction(matrix, view))

    expected = jax.jit(jax.vmap(other))(views, alpha_x, alpha_y)
    # The other formula loses digits as the condition number of the matrix, 1/α² = 400, does.
    np.testing.assert_allclose(solved(4, views, alpha_x, alpha_y)[1], expected, rtol=1e-10)


def area_at(theta, phi, alpha_x, alpha_y) -> float:
    return float(upper_area(reflection_cone(view_of(theta, phi), np.array([alpha_x, alpha_y]))))


@pytest.mark.parametrize("alpha", [0.01, 0.3, 1.0, 2.0])
def test_area_by_hand(alpha):
    # Normal incidence
    exact = 1 / np.sqrt((1 + alpha**2) * (1 + 0.25))
    np.testing.assert_allclose(area_at(0, 0, alpha, 0.5), exact, rtol=1e-14)
    # Grazing view: half of the visible area, σ/2
    sigma = np.hypot(alpha * np.cos(0.5), 0.5 * np.sin(0.5))
    np.testing.assert_allclose(area_at(90, np.degrees(0.5), alpha, 0.5), sigma / 2, rtol=1e-14)
    # Isotropic: λ²/d
    kappa, mu = 1 - alpha**2, np.cos(1.1)
    d = np.hypot(kappa * mu, 2 * alpha)
    exact = ((kappa * mu + d) / 2) ** 2 / d
    np.testing.assert_allclose(area_at(np.degrees(1.1), 30, alpha, alpha), exact, rtol=1e-14)


def test_area_of_the_sphere_is_one_half():
    for theta in (0, 30, 89.9, 90):
        np.testing.assert_allclose(area_at(theta, 20, 1.0, 1.0), 0.5, rtol=1e-15)


def test_derivatives_are_finite_and_right():
    """At normal incidence two eigenvalues are equal, and at grazing views one is zero."""
    places = [(60, 40, 0.4, 0.7), (0, 0, 0.4, 0.4), (0, 0, 0.2, 0.8), (90, 0, 0.3, 0.3)]
    places += [(90, 90, 0.2, 0.8), (89.9, 30, 0.01, 1.0)]
    points = np.array([[*view_of(theta, phi), *alphas] for theta, phi, *alphas in places])

    def area(point):
        return upper_area(cone_of(*point, FLOAT64_STEPS))

    found = jax.jit(jax.vmap(jax.jacfwd(area)))(points)
    np.testing.assert_allclose(found, jax.jit(jax.vmap(jax.grad(area)))(points), atol=1e-12)
    areas, step = jax.jit(jax.vmap(area)), 1e-6
    for index in range(5):
        shift = step * np.eye(5)[index]
        # A view below the horizon has no cone: the second-order difference is one-sided.
        first, second = areas(points + shift), areas(points + 2 * shift)
        rate = (4 * first - second - 3 * areas(points)) / (2 * step)
        np.testing.assert_allclose(found[:, index], rate, atol=1e-5)
