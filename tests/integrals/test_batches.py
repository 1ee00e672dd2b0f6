"""Batches of points: one size, and results that are joined."""

import numpy as np

from integrals.batches import in_batches


def test_in_batches_joins_all_results():
    sizes = []

    def function(points):
        sizes.append(len(points))
        return points[:, 0], points @ np.ones((2, 3))

    points = np.arange(14.0).reshape(7, 2)
    first, table = in_batches(function, points, 3)
    assert sizes == [3, 3, 3]
    np.testing.assert_array_equal(first, points[:, 0])
    np.testing.assert_array_equal(table, points @ np.ones((2, 3)))
