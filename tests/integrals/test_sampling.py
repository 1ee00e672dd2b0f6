"""Numbers of points, weights of errors, and the points near a fibre where P_s is steep."""

import numpy as np
import pytest

from integrals import PS, REFERENCES, Sampling
from integrals.sampling import Measure
from tests.integrals.problems import RIGHT


def points(count: int) -> np.ndarray:
    """Return points (count, 4) of the domain of P_s, φ in [0, π]."""
    unit = np.random.default_rng(0).random((count, 4))
    return np.array([0.02, 0, 0, 0]) + unit * [0.98, RIGHT, RIGHT, np.pi]


def test_by_default_all_points_count_the_same():
    sampling = Sampling(fitted=5, checked=6, judged=7)
    assert sampling.climbs
    assert sampling.extra is None
    assert sampling.verified is None
    assert list(sampling.measures) == ["uniform"]
    for weight in (sampling.measures["uniform"].density, sampling.measures["uniform"].largest):
        np.testing.assert_array_equal(weight(points(3)), np.ones(3))


# They are smooth, and slow to evaluate.
DO_NOT_CLIMB = (
    *("r", "ggx-scale", "ggx-bias", "ggx-average-albedo"),
    *("sggx-filter", "sggx-filter-axes"),
)


@pytest.mark.parametrize("name", REFERENCES)
def test_every_reference_has_its_own_sampling(name):
    sampling = REFERENCES[name].sampling
    assert sampling.judged > max(sampling.fitted, sampling.checked) - 1
    assert sampling.measures["uniform"] == Measure()
    assert (len(sampling.measures) > 1) == (name == "ps")
    assert sampling.climbs == (name not in DO_NOT_CLIMB)


def test_measures_of_lights_are_angle_solid_angle_and_projected_solid_angle():
    sample, measures = points(50), PS.sampling.measures
    theta_u = sample[:, 2]
    expected = {
        "uniform": (np.ones(50), np.ones(50)),
        "solid-angle": (np.sin(theta_u), np.ones(50)),
        "cosine": (np.sin(theta_u) * np.cos(theta_u), np.cos(theta_u)),
    }
    assert list(measures) == list(expected)
    for name, (density, largest) in expected.items():
        np.testing.assert_array_equal(measures[name].density(sample), density)
        np.testing.assert_array_equal(measures[name].largest(sample), largest)


def test_extra_points_of_ps_are_near_the_fibre():
    sample = points(1000)
    moved = PS.sampling.extra(sample)
    assert moved.shape == sample.shape
    np.testing.assert_array_equal(moved[:, :2], sample[:, :2])
    for axis, values in zip(PS.axes, moved.T, strict=True):
        assert axis.contains(values).all()
    alpha, theta_f, theta_u, phi = moved.T
    cosine = np.cos(theta_u) * np.cos(theta_f) + np.sin(theta_u) * np.sin(theta_f) * np.cos(phi)
    angle = np.arccos(np.clip(cosine, -1, 1))
    # A light below the horizon is put on it, which brings it nearer to the fibre.
    sharp = alpha < 0.3
    assert sharp.sum() > 100
    assert np.all(angle[sharp] <= 5 * alpha[sharp] + 1e-7)
    assert np.median(angle[sharp] / alpha[sharp]) < 2.5
