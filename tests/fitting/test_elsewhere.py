"""Where a form has larger errors than at the points of its fit."""

from dataclasses import replace

import numpy as np
import pytest

from fitting import Goal
from fitting.points.sample import sample_of
from fitting.solvers.elsewhere import Elsewhere
from integrals import REFERENCES, Sampling
from tests.fitting.toys import PLANE, TOY

GOAL = Goal("linf")
FLAT = np.array([2.0, -1.0, 0.3])


def elsewhere(**sampling) -> Elsewhere:
    """Return the errors of a plane, by a reference with another sampling."""
    reference = replace(TOY, sampling=Sampling(fitted=7, checked=8, judged=8, **sampling))
    return Elsewhere(replace(PLANE, reference=reference), FLAT, GOAL, "uniform", 3)


def test_a_search_climbs_from_the_points_of_the_fit_too():
    """Without climbing only points of the finer set are returned."""
    found = {}
    for name, sampling in (
        ("long", {}),
        ("short", {"climbs": False, "refined": 288}),
        ("none", {"climbs": False}),
    ):
        errors = elsewhere(**sampling)
        sample = sample_of(errors.form, GOAL)
        sizes = errors.size(sample.points, sample.exact)
        worst, largest = errors.worst(10, sample, sizes)
        found[name] = len(worst.points), largest
        assert largest == pytest.approx(errors.size(worst.points, worst.exact).max())
    assert found["none"][0] == 10 < found["short"][0]
    assert found["none"][1] <= found["short"][1] <= found["long"][1] * (1 + 1e-6)


def test_uphill_keeps_the_points_and_adds_maxima():
    errors = elsewhere()
    points = np.array([[0.9, 1.9], [0.1, -0.9]])
    found = errors.uphill(points)
    np.testing.assert_array_equal(found.points[:2], points)
    sizes = errors.size(found.points, found.exact)
    assert len(sizes) == 4 and sizes[2:].max() > sizes[:2].max()


@pytest.mark.slow
def test_proofs_of_r_use_more_exact_values():
    reference, points = REFERENCES["r"], np.array([[0.15, 0.3], [0.16, 1.2]])
    usual, better = reference.estimates(points), reference.estimates(points, for_proof=True)
    assert np.max(better.error) < 1e-3 * np.max(usual.error)
    assert np.all(np.abs(usual.value - better.value) <= usual.error)
