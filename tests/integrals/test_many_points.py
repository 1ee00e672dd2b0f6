"""Exact values at many points: in the given order, and with the options that the points need."""

from dataclasses import replace

import jax.numpy as jnp
import numpy as np
import pytest

from integrals import Axis, Estimate, Q, Reference, Sampling
from integrals.many_points import estimates_at_many

AXES = (Axis("a", 0.0, 1.0), Axis("b", 0.0, 1.0))


def with_nodes(a, b, *, nodes: int) -> Estimate:
    """Stand for an integral: the error says how many nodes it was given."""
    return Estimate(jnp.sin(3 * a) + b, jnp.full((), 1.0 / nodes))


# A batch of 64 points is that of a slow quantity. Low values of a need more nodes.
SLOW = Reference(
    name="slow",
    symbol="S",
    meaning="",
    definition="",
    axes=AXES,
    sampling=Sampling(fitted=3, checked=3, judged=3),
    quadrature=with_nodes,
    batch=64,
    options_at=lambda points: {"nodes": 8 if points[:, 0].min() < 0.25 else 2},
)


def test_points_are_evaluated_in_their_order_with_the_options_that_they_need():
    points = np.random.default_rng(1).uniform(0, 1, (1000, 2))
    found = estimates_at_many(SLOW, points)
    a, b = points.T
    np.testing.assert_allclose(found.value, np.sin(3 * a) + b, rtol=1e-14)
    assert (np.asarray(found.error)[a < 0.25] == 1 / 8).all()
    # At most one block of 64 points has points of both kinds.
    assert (np.asarray(found.error)[a >= 0.25] == 1 / 8).sum() < 64
    # All points at once take the options of the hardest.
    assert (np.asarray(SLOW.estimates(points).error) == 1 / 8).all()


def test_a_quantity_with_a_closed_form_is_evaluated_as_ever():
    points = np.linspace(0, 1, 9)[:, None]
    np.testing.assert_array_equal(estimates_at_many(Q, points).value, Q.values(points))


@pytest.mark.parametrize("batch", [8, 8192])
def test_no_points_have_no_values_and_few_points_few(batch):
    for count in (0, 1, 3):
        points = np.full((count, 2), 0.5)
        found = estimates_at_many(replace(SLOW, batch=batch), points)
        assert (found.value.shape, found.error.shape) == ((count,), (count,))
        np.testing.assert_allclose(found.value, np.sin(1.5) + 0.5, rtol=1e-14)
