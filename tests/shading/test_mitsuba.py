"""The SGGX phase function, its sampling and P_s, compared with Mitsuba 3.

The tests are skipped without Mitsuba. `make toolchain-mitsuba` installs it.
"""

import jax
import numpy as np
import pytest

from integrals import PS
from shading import (
    direction,
    fiber_direction,
    fiber_phase_function,
    fiber_root,
    phase_function,
    sample_phase_function,
)
from tests.batches import batched

mitsuba = pytest.importorskip("mitsuba")
mitsuba.set_variant("scalar_rgb")

# The scalar variants of Mitsuba compute in float32 and store S in float32.
FLOAT32 = 1e-6
SAMPLES = 20_000


def mitsuba_phase_function(matrix):
    """Return the phase function of Mitsuba for an SGGX matrix (3, 3) that is constant in space."""
    order = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]
    grid = np.tile(np.array([matrix[i] for i in order], np.float32), (2, 2, 2, 1))
    volume = {"type": "gridvolume", "grid": mitsuba.VolumeGrid(grid), "raw": True}
    return mitsuba.load_dict({"type": "sggx", "S": volume | {"filter_type": "nearest"}})


def interaction(light):
    """Return a point of a medium that is lit from the unit vector `light`."""
    place = mitsuba.MediumInteraction3f()
    place.p = mitsuba.Point3f(0.5, 0.5, 0.5)
    place.wi = mitsuba.Vector3f(*map(float, light))
    place.sh_frame = mitsuba.Frame3f(place.wi)
    return place


def evaluate(matrix, light, view) -> float:
    context = mitsuba.PhaseFunctionContext()
    towards = mitsuba.Vector3f(*map(float, view))
    return float(mitsuba_phase_function(matrix).eval_pdf(context, interaction(light), towards)[1])


def samples(matrix, light, seed) -> tuple[np.ndarray, np.ndarray]:
    """Let Mitsuba draw views (n, 3), and return them with their densities (n,).

    They are drawn in a frame whose z axis is the light. Only there do the samples of Mitsuba 3.9.1
    follow its own density (docs/brdf.md).
    """
    frame, _ = np.linalg.qr(np.column_stack([light, np.eye(3)[:, :2]]))
    frame = np.roll(frame * np.sign(frame[:, 0] @ light), -1, axis=1)
    phase, place = mitsuba_phase_function(frame.T @ matrix @ frame), interaction((0.0, 0.0, 1.0))
    context = mitsuba.PhaseFunctionContext()
    drawn = [
        phase.sample(context, place, float(x), mitsuba.Point2f(float(y), float(z)))
        for x, y, z in np.random.default_rng(seed).random((SAMPLES, 3))
    ]
    views = np.array([list(each[0]) for each in drawn]) @ frame.T
    return views, np.array([float(each[2]) for each in drawn])


def rounded(matrix) -> np.ndarray:
    """Round a matrix to float32 as Mitsuba does, so that only the evaluation is compared."""
    return np.asarray(matrix, np.float32).astype(float)


def test_phase_function_of_random_matrices_agrees():
    rng = np.random.default_rng(0)
    ours, theirs = [], []
    for _ in range(100):
        axes, _ = np.linalg.qr(rng.normal(size=(3, 3)))
        matrix = rounded((axes * rng.uniform(0.4, 1, 3) ** 2) @ axes.T)
        matrix = (matrix + matrix.T) / 2
        light, view = (rounded(w / np.linalg.norm(w)) for w in rng.normal(size=(2, 3)))
        ours.append((matrix, light, view))
        theirs.append(evaluate(matrix, light, view))
    values = jax.jit(jax.vmap(phase_function))(*map(np.stack, zip(*ours, strict=True)))
    np.testing.assert_allclose(theirs, values, rtol=FLOAT32)


def test_phase_function_of_fibres_agrees():
    fiber, light = np.asarray(fiber_direction(0.9)), np.asarray(direction(0.5, 0.3))
    root = np.asarray(fiber_root(fiber, 0.5))
    for theta, phi in ((0.2, 1.0), (1.2, -2.0), (2.5, 0.4)):
        view = np.asarray(direction(theta, phi))
        ours = fiber_phase_function(light, view, fiber, 0.5)
        np.testing.assert_allclose(evaluate(root @ root.T, light, view), ours, rtol=FLOAT32 * 5)


@pytest.mark.parametrize("theta_u", [0.3, 1.4])
def test_samples_have_the_same_moments(theta_u):
    """The means of the directions and of their squares agree within five standard errors."""
    light = np.asarray(direction(theta_u, 0.7))
    root = np.asarray(fiber_root(fiber_direction(0.9), 0.4))
    theirs, density = samples(root @ root.T, light, 1)
    ours = np.asarray(
        jax.jit(jax.vmap(sample_phase_function, (None, None, 0)))(
            root, light, np.random.default_rng(2).random((SAMPLES, 2))
        )
    )
    for power in (1, 2):
        a, b = theirs**power, ours**power
        error = np.sqrt((a.var(axis=0) + b.var(axis=0)) / SAMPLES)
        assert np.all(abs(a.mean(axis=0) - b.mean(axis=0)) < 5 * error)
    expected = jax.jit(jax.vmap(phase_function, (None, None, 0)))(root @ root.T, light, theirs)
    assert np.median(np.abs(density / expected - 1)) < 5 * FLOAT32


def test_ps_agrees_with_the_samples_of_mitsuba():
    points = np.array(
        [
            (0.2, 0.4, 0.3, 1.0),
            (0.35, 0.785, 0.52, 1.57),
            (0.5, 1.5, 1.4, 0.2),
            (0.9, 1.0, 1.0, 3.0),
        ]
    )
    exact = batched(PS.value, 4)(*points.T)
    for (alpha, theta_f, theta_u, phi), value in zip(points, exact, strict=True):
        root = np.asarray(fiber_root(fiber_direction(theta_f), alpha))
        views, _ = samples(root @ root.T, np.asarray(direction(theta_u, phi)), 3)
        error = np.sqrt(value * (1 - value) / SAMPLES)
        assert abs(np.mean(views[:, 2] < 0) - value) < 5 * error
