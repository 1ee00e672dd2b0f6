"""The closed moments of the lit normals, compared with a quadrature over their cone."""

import functools

import jax
import numpy as np

from integrals import PS
from shading.fuzz.lit_moments import lit_moments
from tests.batches import batched
from tests.integrals.problems import RIGHT, awkward_points

# (α, θf, θv, φ), then (1 − P_s, λ, T_w), and r along n, v and t, from an independent computation.
POINTS = np.array(
    [
        (0.5, np.pi / 4, np.pi / 3, np.pi / 3),
        (np.sqrt(0.05), np.pi / 4, np.arccos(0.35), np.pi / 4),
        (np.sqrt(0.05), RIGHT, np.arccos(0.1), np.pi),
        (np.sqrt(0.5), np.radians(23), np.arccos(0.7), np.radians(135)),
        (1.0, 0.0, np.pi / 3, 0.0),
    ]
).T
SCALARS = np.array(
    [
        (0.332402587, 0.451150369, 0.672220275),
        (0.139343315, 0.143027456, 0.551686456),
        (0.590937396, 0.276096260, 0.595835551),
        (0.423374831, 0.683784921, 0.796905047),
        (0.5, 1.0, 1.0),
    ]
).T
DIRECTIONS = np.array(
    [
        (0.869327, 0.304992, -0.970513),
        (1.101626, 0.339628, -1.542721),
        (0.175899, 0.557894, 1.458897),
        (0.768588, 0.168876, -0.497309),
        (0.5, 0.0, 0.0),
    ]
)


@functools.cache
def moments(dtype=float):
    evaluate = jax.jit(jax.vmap(lit_moments))
    return lambda *each: jax.tree.map(np.asarray, evaluate(*(np.asarray(x, dtype) for x in each)))


def vectors(points):
    """Return v and t, (count, 3) each, and α, of points (4, count)."""
    alpha, theta_f, theta_v, phi = points
    sine = np.sin(theta_v)
    v = np.stack([sine * np.cos(phi), sine * np.sin(phi), np.cos(theta_v)], axis=1)
    return v, np.stack([np.sin(theta_f), 0 * theta_f, np.cos(theta_f)], axis=1), alpha


def at(points, dtype=float):
    v, t, alpha = vectors(points)
    return moments(dtype)(v[:, 2], np.sum(v * t, axis=1), t[:, 2], alpha)


def in_space(coordinates, v, t):
    """Return the vectors (count, 3) with coordinates (count, 3) along n, v and t."""
    n = np.array([0.0, 0.0, 1.0])
    return coordinates[:, :1] * n + coordinates[:, 1:2] * v + coordinates[:, 2:] * t


def cone_quadrature(v, t, alpha):
    """Return λ, E[wwᵀ | lit] and the axis of the cone, by a rule over its elliptic section.

    The lit p = x₁e₁ + x₂e₂ + x₃e₃ fill an ellipse of (x₂, x₃), where they have the density
    (p·ẑ)/x₁. The rule takes midpoints in azimuth and Gauss-Legendre nodes in the squared radius.
    """
    n = np.array([0.0, 0.0, 1.0])
    root = np.eye(3) - (1 - alpha) * np.outer(t, t)
    bend = np.outer(v, n) + np.outer(n, v) - v[2] * np.eye(3)
    image = root @ bend @ root
    values, axes = np.linalg.eigh((image + image.T) / 2)
    values, axes = values[::-1], axes[:, ::-1]
    seen = axes.T @ (root @ v)
    seen, axes = seen * np.sign(seen[0]), axes * np.sign(seen[0])
    squares, weights = np.polynomial.legendre.leggauss(24)
    radius = np.sqrt((squares + 1) / 2)[:, None]
    azimuth = (np.arange(24) + 0.5) * 2 * np.pi / 24
    extents = np.sqrt(values[0] / (values[0] - values[1:]))
    x2, x3 = radius * np.cos(azimuth) * extents[0], radius * np.sin(azimuth) * extents[1]
    x1 = np.sqrt(1 - x2**2 - x3**2)
    x = np.stack([x1, x2, x3]).reshape(3, -1)
    mass = np.repeat(weights, 24) * (seen @ x) / x[0]
    second = (mass * x) @ x.T / mass.sum()
    return values[0], root @ axes @ second @ axes.T @ root, root @ axes[:, 0]


def test_table():
    value = at(POINTS)
    found = np.stack([value.fraction, value.root, value.mean_square])
    np.testing.assert_allclose(found, SCALARS, rtol=0, atol=5.1e-10)
    np.testing.assert_allclose(value.direction, DIRECTIONS, rtol=0, atol=5.1e-7)


def test_moments_are_those_of_the_cone():
    points = awkward_points(1, 300, 0.15)
    v, t, alpha = vectors(points)
    value = at(points)
    seen, axis = in_space(value.seen, v, t), in_space(value.axis, v, t)
    axis /= np.linalg.norm(axis, axis=1)[:, None]
    for index in range(len(alpha)):
        root, second, along = cone_quadrature(v[index], t[index], alpha[index])
        assert abs(value.root[index] - root) < 1e-13
        assert abs(value.mean_square[index] - np.trace(second)) < 1e-13
        assert np.abs(seen[index] - second @ v[index]).max() < 1e-13
        assert np.abs(axis[index] - along / np.linalg.norm(along)).max() < 1e-12


def test_fraction_is_that_of_the_closed_form():
    points = awkward_points(2, 300, 0.15)
    exact = 1 - batched(PS.value, 64)(*points)
    np.testing.assert_allclose(at(points).fraction, exact, rtol=0, atol=1e-13)


def invariants(points, dtype):
    """Return the errors of r·n = λ/(2T_w) and of v·W = (λ + c)(λσ² + m)."""
    v, t, alpha = vectors(points)
    value = at(points, dtype)
    mean = in_space(value.direction, v, t)[:, 2] - value.root / (2 * value.mean_square)
    sigma2 = 1 - (1 - alpha**2) * np.sum(v * t, axis=1) ** 2
    size = (value.root + v[:, 2]) * (value.root * sigma2 + alpha**2 * v[:, 2])
    along = np.sum(in_space(value.axis, v, t) * v, axis=1) - size
    return abs(mean).max(), abs(along).max()


def test_invariants():
    points = awkward_points(3, 1000, 0.15)
    assert max(invariants(points, float)) < 1e-13
    value = at(points)
    alpha = points[0]
    assert np.all((value.mean_square <= 1 + 1e-14) & (value.mean_square >= alpha**2))
    assert np.all((value.cosine > 0) & (value.cosine <= 1 + 1e-14))


def test_invariants_in_float32():
    points = awkward_points(4, 1000, 0.15)
    mean, along = invariants(points, np.float32)
    assert mean < 1e-4
    assert along < 1e-5


def test_even_in_the_fibre():
    points = awkward_points(5, 200, 0.05)
    v, t, alpha = vectors(points)
    a, sign = np.sum(v * t, axis=1), np.array([1.0, 1.0, -1.0])
    one, other = moments()(v[:, 2], a, t[:, 2], alpha), moments()(v[:, 2], -a, -t[:, 2], alpha)
    np.testing.assert_array_equal(one.mean_square, other.mean_square)
    np.testing.assert_array_equal(one.direction, other.direction * sign)


def test_isotropic_fibres():
    """At α = 1 the lit directions are uniform over the hemisphere, so r = n/2 and T_w = 1."""
    points = awkward_points(6, 100, 0.15)
    points[0] = 1.0
    v, t, _ = vectors(points)
    value = at(points)
    expected = np.broadcast_to([0, 0, 0.5], v.shape)
    np.testing.assert_allclose(in_space(value.direction, v, t), expected, rtol=0, atol=1e-14)
    np.testing.assert_allclose(value.mean_square, 1, rtol=0, atol=1e-15)


def test_grazing_views_are_finite():
    """λ ≥ α² also at v·n = 0, so values and derivatives are finite there, and continuous."""
    grid = np.meshgrid([0.05, 0.15, 0.6, 1.0], [0.0, 0.3, 1.2, RIGHT], [0.0, 0.7, RIGHT, np.pi])
    alpha, theta_f, phi = (axis.ravel() for axis in grid)
    a, b = np.sin(theta_f) * np.cos(phi), np.cos(theta_f)
    gradient = jax.jit(jax.vmap(jax.jacrev(lambda x: lit_moments(*x))))
    slopes = gradient(np.stack([0 * a, a, b, alpha], axis=1))
    assert all(np.all(np.isfinite(each)) for each in slopes)
    for dtype, least, near in ((float, 1e-12, 1e-8), (np.float32, 1e-7, 2e-3)):
        here = moments(dtype)(0 * a, a, b, alpha)
        beside = moments(dtype)(np.full_like(a, least), a, b, alpha)
        for one, other in zip(here, beside, strict=True):
            assert np.all(np.isfinite(one))
            np.testing.assert_allclose(one, other, rtol=0, atol=near)
