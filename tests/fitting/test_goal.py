"""What a fit may make small."""

from typing import get_args

import pytest

from fitting import Goal
from fitting.goal import LEAST_SQUARES, Side


def test_by_default_a_fit_makes_squared_errors_small():
    assert Goal() == LEAST_SQUARES == Goal("l2", False, "both", "none", False)


def test_least_squares_have_no_side_and_no_bounds():
    with pytest.raises(ValueError, match="side = 'below' with norm = 'l2'"):
        Goal("l2", side="below")
    with pytest.raises(ValueError, match="bounded = True with norm = 'l2'"):
        Goal(bounded=True)


@pytest.mark.parametrize("side", get_args(Side))
@pytest.mark.parametrize("bounded", [False, True])
def test_the_largest_error_may_have_a_side_and_bounds(side, bounded):
    assert Goal("linf", side=side, bounded=bounded).side == side
