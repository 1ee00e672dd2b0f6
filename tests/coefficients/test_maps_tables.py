"""What the tables of filtered lobes reach, and the filters in print."""

import numpy as np
import pytest

from coefficients.catalogue import resolve
from fitting import form_values
from integrals import SGGX_FILTER, SGGX_FILTER_AXES

SHARES = np.linspace(0, 1, 401)[:, None]


def relative(name: str, points: np.ndarray, exact: np.ndarray) -> np.ndarray:
    return form_values(resolve(name).require_fitted(), points) / exact - 1


@pytest.mark.parametrize(
    ("name", "size", "most"),
    [
        ("best/sggx-filter-9", 3, 0.012),
        ("best/sggx-filter-11", 4, 0.0027),
        ("best/sggx-filter-15", 6, 0.0004),
        ("best/sggx-filter-axes-19", 7, 0.0081),
        ("best/sggx-filter-axes-24", 9, 0.0075),
    ],
)
def test_a_table_states_its_error_and_has_no_pole(name, size, most):
    table = resolve(name).require_table()
    assert np.size(table.coefficients) == size
    assert table.errors.off_grid.max <= most
    assert table.certificates.denominator_bound > 0


@pytest.mark.slow
def test_the_filters_in_print_have_the_stated_relative_errors():
    exact = SGGX_FILTER.values(SHARES)
    talk, lean = (relative(f"published/sggx-filter{x}", SHARES, exact) for x in ("", "-lean"))
    # The talk is too narrow everywhere, LEAN is too wide.
    assert talk.max() <= 1e-13 and lean.min() >= -1e-13
    assert talk.min() == pytest.approx(-0.2566, abs=5e-4)
    assert lean.max() == pytest.approx(0.639, abs=5e-4)
    best = relative("best/sggx-filter-9", SHARES, exact)
    assert np.max(np.abs(best)) <= 0.012
    ends = np.array([[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0], [0.999, 0.02]])
    both = SGGX_FILTER_AXES.values(ends)
    # Along an axis that is spread far, without any spread across it.
    assert relative("published/sggx-filter-axes-lean", ends, both)[2] == pytest.approx(
        0.668, abs=1e-3
    )
    assert np.max(np.abs(relative("best/sggx-filter-axes-24", ends, both))) <= 0.0075
