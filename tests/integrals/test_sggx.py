"""P_s of any SGGX matrix: the closed form, compared with 50 digits and with quadrature."""

import functools

import numpy as np

from integrals import PS
from integrals.fuzz.sggx import sggx_quadrature, sggx_scattered_fraction
from shading import direction
from tests.batches import batched
from tests.integrals.problems import awkward_points, distance, exact_sggx

EPS = np.finfo(float).eps
# The largest difference of closed form and quadrature where the rule resolves the distribution.
AGREEMENT = 1e-12


@functools.cache
def fiber_closed_form():
    return batched(PS.closed_form, 256)


@functools.cache
def general():
    def value(matrix, theta_u, phi):
        return sggx_scattered_fraction(matrix, direction(theta_u, phi))

    return batched(value, 256)


def random_matrices(seed, count, least_axis):
    """Return positive definite matrices (count, 3, 3): flat, long and others, of any scale."""
    rng = np.random.default_rng(seed)
    axes = np.exp(rng.uniform(np.log(least_axis), 0, (count, 3)))
    kind = rng.integers(0, 3, count)
    axes[kind == 1, 1:] = axes[kind == 1, 1:2]
    axes[kind == 2, :2] = 1
    frames = np.linalg.qr(rng.normal(size=(count, 3, 3)))[0]
    scaled = np.einsum("nij,nj,nkj->nik", frames, axes**2, frames)
    return (scaled + scaled.swapaxes(1, 2)) / 2 * 10 ** rng.uniform(-2, 2, (count, 1, 1))


def random_lights(seed, count):
    _, _, theta_u, phi = awkward_points(seed, count, 0.5)
    return theta_u, phi


def test_closed_form_is_exact_up_to_the_condition_of_the_matrix():
    matrices, (theta_u, phi) = random_matrices(8, 300, 0.02), random_lights(8, 300)
    value = general()(matrices, theta_u, phi)
    truth = [exact_sggx(*point) for point in zip(matrices, theta_u, phi, strict=True)]
    assert np.all(distance(value, truth) <= 4 * EPS * np.linalg.cond(matrices))


def test_closed_form_agrees_with_the_quadrature():
    matrices, (theta_u, phi) = random_matrices(9, 48, 0.1), random_lights(9, 48)
    value = general()(matrices, theta_u, phi)
    estimate = batched(sggx_quadrature, 8)(matrices, theta_u, phi)
    rounding = 4 * EPS * np.linalg.cond(matrices)
    gap = abs(value - estimate.value)
    assert np.all(gap <= estimate.error + rounding)
    resolved = np.linalg.cond(matrices) < 0.15**-2
    assert np.all(gap[resolved] <= AGREEMENT)


def test_closed_form_of_a_fibre_is_a_special_case():
    alpha, theta_f, theta_u, phi = points = awkward_points(10, 300, 0.02)
    fiber = np.stack([np.sin(theta_f), np.zeros_like(theta_f), np.cos(theta_f)], axis=1)
    matrices = np.eye(3) - (1 - alpha**2)[:, None, None] * fiber[:, :, None] * fiber[:, None]
    value = general()(matrices, theta_u, phi)
    assert np.all(abs(value - fiber_closed_form()(*points).value) <= 4 * EPS / alpha**2)
