"""Proof that all values of a form lie between 0 and 1."""

import functools
from dataclasses import replace

import jax.numpy as jnp
import numpy as np
import pytest

from fitting import Proofs
from fitting.form import traced
from fitting.points.scattered import scattered_points
from fitting.proofs import range_proof
from fitting.proofs.range_proof import certify_range
from programs import BranchAndBound, evaluate
from quantities.fuzz.supplement import QUADRATIC_Q, RATIONAL_G, RATIONAL_R
from tests.fitting.toys import toy_form


def values_of(fitted) -> np.ndarray:
    points = scattered_points(fitted.reference, fitted.axes, 13, 5)
    return evaluate(traced(fitted, fitted, fitted.axes), points)[:, 0]


# 1 + c₀d + c₁d² on [0, ½] is least at d = 0.3, between any nodes, and is 1 at d = 0.
@pytest.mark.parametrize(("least", "proven"), [(1e-6, True), (-1e-6, False), (-0.1, False)])
def test_a_value_just_below_zero_is_told_from_one_just_above(least, proven):
    c1 = (1 - least) / 0.09
    found = certify_range(QUADRATIC_Q.fitted(np.array([-0.6 * c1, c1])))
    assert (found is not None) == proven
    if found is not None:
        assert 0 <= found.lower <= least


@pytest.mark.parametrize("slope", [1e-9, 0.3])
def test_a_value_above_one_is_found(slope):
    assert certify_range(QUADRATIC_Q.fitted(np.array([-1.0, 2 + 4 * slope]))) is None
    assert certify_range(QUADRATIC_Q.fitted(np.array([-1.0, 2 - 4 * slope]))) is not None


def test_not_a_number_is_not_between_zero_and_one():
    assert certify_range(QUADRATIC_Q.fitted(np.array([np.nan, 1.0]))) is None


G = RATIONAL_G.fitted(np.array([-0.8, 0.3, 0.9, -0.2]))
R = RATIONAL_R.fitted(np.concatenate([np.sin(np.arange(14)) / 30, [0.5, -0.4, 0.3]]))


def test_a_search_that_reaches_its_limit_proves_nothing(monkeypatch):
    assert certify_range(R) is not None
    limited = functools.partial(BranchAndBound, max_boxes=5)
    monkeypatch.setattr(range_proof, "BranchAndBound", limited)
    assert certify_range(R) is None


@pytest.mark.parametrize("fitted", [G, R], ids=["G", "R"])
def test_bounds_are_tighter_with_more_boxes(fitted):
    values = values_of(fitted)
    loose, tight = (certify_range(fitted, tightness) for tightness in (0.1, 1e-4))
    assert loose is not None
    assert tight is not None
    assert loose.boxes < tight.boxes
    for found, room in ((loose, 0.1), (tight, 1e-4)):
        assert values.min() - room - 1e-4 <= found.lower <= values.min()
        assert values.max() <= found.upper <= values.max() + room + 1e-4


# x² + 0.2 y on [0, 1] × [−1, 2], with margins that say whether its values are in [0, 1].
def with_margins(margins):
    form = toy_form(lambda c, x, y: x * x * c[0] + 0.2 * y, ["a"])
    return replace(form, proofs=Proofs(margins=margins)).fitted(np.array([0.5]))


def test_margins_that_are_nowhere_negative_prove_the_range():
    found = certify_range(with_margins(lambda c, x, y: (jnp.asarray(1 + y), 1 - x * c[0])))
    assert found is not None
    assert (found.lower, found.upper) == (0, 1)
    assert found.boxes > 0


def test_a_single_negative_margin_leaves_it_unproven():
    """The second margin is negative near x = 1 only in the first of these."""
    assert certify_range(with_margins(lambda c, x, y: (1 + y, c[0] - 0.51 * x))) is None
    assert certify_range(with_margins(lambda c, x, y: (1 + y, c[0] - 0.49 * x))) is not None


def test_without_a_margin_there_is_nothing_to_show():
    found = certify_range(with_margins(lambda c, x, y: ()))
    assert found is not None
    assert (found.lower, found.upper, found.boxes) == (0, 1, 0)


@pytest.mark.parametrize("codomain", [(-1.0, 1.0), (-np.inf, np.inf), (-0.21, np.inf)])
def test_a_codomain_may_have_any_ends(codomain):
    form = toy_form(lambda c, x, y: x * x * c[0] + 0.2 * y, ["a"])
    reference = replace(form.reference, codomain=codomain)
    found = certify_range(replace(form, reference=reference).fitted(np.array([0.5])))
    assert found is not None
    # The values are from −0.2 to 0.9. The bounds are within a thousandth of the width.
    room = 1e-3 * (2 if codomain[1] == 1 else 1.1)
    assert -0.2 - room <= found.lower <= -0.2
    assert 0.9 <= found.upper <= 0.9 + room
    assert found.lower >= codomain[0] - 1e-12
    below = replace(form.reference, codomain=(-0.19, codomain[1]))
    assert certify_range(replace(form, reference=below).fitted(np.array([0.5]))) is None
