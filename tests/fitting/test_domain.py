"""The part of the axes that several forms have in common."""

from dataclasses import replace

import numpy as np
import pytest

from fitting import Domain, common_domain
from integrals import Q
from quantities import problem
from quantities.fuzz.supplement import RATIONAL_R

BELOW = Domain(Q, (replace(Q.axes[0], upper=0.2),))
ABOVE = Domain(Q, (replace(Q.axes[0], lower=0.2, upper=0.5),))


def test_the_common_part_has_the_highest_lower_and_the_lowest_upper_ends():
    middle = Domain(Q, (replace(Q.axes[0], lower=0.1, upper=0.4),))
    for pair in ([middle, ABOVE], [ABOVE, middle]):
        (axis,) = common_domain(pair).axes
        assert (axis.lower, axis.upper) == (0.2, 0.4)
    assert common_domain([ABOVE, ABOVE]) == ABOVE


def test_domains_without_a_common_part_are_refused():
    with pytest.raises(ValueError, match=r"density .* in common: \[0, 0.2\] and \[0.2, 0.5\]$"):
        common_domain([BELOW, ABOVE])


def test_an_open_end_stays_open():
    whole = Domain(RATIONAL_R.reference, RATIONAL_R.reference.axes)
    assert whole.axes[0].open_below
    assert common_domain([whole, whole]).axes[0].open_below
    assert not common_domain([whole, RATIONAL_R]).axes[0].open_below


def test_forms_have_their_own_domain():
    wide = problem("r").find_form(
        "monomial-r",
        {"variable": "1-alpha", "numerator": [[0, 0]], "denominator": [], "least_alpha": 0.05},
    )
    found = common_domain([wide, RATIONAL_R])
    assert found.reference is RATIONAL_R.reference
    assert [(axis.lower, axis.upper) for axis in found.axes] == [(0.15, 1.0), (0.0, np.pi / 2)]
