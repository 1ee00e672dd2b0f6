import functools

import jax.numpy as jnp
import numpy as np
import pytest
from fitting.families.ps import cubic_ps, one_root_ps, two_root_ps

from coefficients.catalogue import form_of, load, names_of_best
from fitting import PAPER_FORMS, QuadraticQ
from fitting.errors import check_reference, form_values
from fitting.form import traced
from fitting.points.scattered import spread_points
from fitting.proofs.range_proof import ROUNDING, TIGHTNESS, certify_range
from programs.bounding import branch_and_bound as branch
from programs.program import evaluate

REFITS = ("ps", "g", "q", "r")
QUICK = ("best/ps-36-wide", "best/ps-40", "best/r-25", "r")
TABLES = (*names_of_best(), *REFITS)
SOME = [
    name
    if name in QUICK or load(name).quantity in "gq"
    else pytest.param(name, marks=pytest.mark.slow)
    for name in TABLES
]


def values_of(form) -> np.ndarray:
    points = spread_points(form.integral.name, form.axes, 13, 5)
    return evaluate(traced(form, form, form.axes), points)[:, 0]


@pytest.mark.parametrize("name", SOME)
def test_a_table_states_the_range_that_is_proven_of_it(name):
    table, form = load(name), form_of(load(name))
    assert table.certificates is not None
    found, values = certify_range(form), values_of(form)
    if found is None:
        assert table.certificates.range is None
        assert values.min() < 0 or values.max() > 1
        return
    assert table.certificates.range == pytest.approx([found.lower, found.upper], abs=TIGHTNESS)
    assert found.lower <= values.min() <= values.max() <= found.upper
    assert -ROUNDING <= found.lower <= found.upper <= 1 + ROUNDING
    if table.quantity != "ps":
        assert values.min() - found.lower < 3 * TIGHTNESS
        assert found.upper - values.max() < 3 * TIGHTNESS


def test_all_tables_but_that_of_the_paper_s_form_of_ps_are_fractions():
    """Which ones are not is a fact that README states."""
    without = [name for name in TABLES if not _range(name)]
    assert without == ["ps"]


def _range(name: str):
    certificates = load(name).certificates
    assert certificates is not None
    return certificates.range


# 1 + c₀d + c₁d² on [0, ½] is least at d = 0.3, between any nodes, and is 1 at d = 0.
@pytest.mark.parametrize(("least", "proven"), [(1e-6, True), (-1e-6, False), (-0.1, False)])
def test_a_value_below_zero_is_found_and_one_just_above_is_not_mistaken_for_one(least, proven):
    c1 = (1 - least) / 0.09
    found = certify_range(QuadraticQ(jnp.array([-0.6 * c1, c1])))
    assert (found is not None) == proven
    if found is not None:
        assert 0 <= found.lower <= least


@pytest.mark.parametrize("slope", [1e-9, 0.3])
def test_a_value_above_one_is_found(slope):
    assert certify_range(QuadraticQ(jnp.array([-1.0, 2 + 4 * slope]))) is None
    assert certify_range(QuadraticQ(jnp.array([-1.0, 2 - 4 * slope]))) is not None


def test_not_a_number_is_no_fraction():
    assert certify_range(QuadraticQ(jnp.array([np.nan, 1.0]))) is None


def test_the_published_ps_is_no_fraction():
    form = form_of(load("published/ps"))
    assert values_of(form).min() < -0.05
    assert certify_range(form) is None


def test_a_search_that_finds_no_end_proves_nothing(monkeypatch):
    form = form_of(load("best/g-19"))
    assert certify_range(form) is not None
    monkeypatch.setattr(branch, "MAX_BOXES", 5)
    assert certify_range(form) is None


def test_bounds_are_tighter_with_more_boxes():
    form = form_of(load("published/r"))
    values = values_of(form)
    loose, tight = (certify_range(form, tightness) for tightness in (0.1, 1e-4))
    assert loose is not None
    assert tight is not None
    assert loose.boxes < tight.boxes
    for found, room in ((loose, 0.1), (tight, 1e-4)):
        assert values.min() - room <= found.lower <= values.min()
        assert values.max() <= found.upper <= values.max() + room


# Families of P_s, and how far coefficients are from zero to give values in and out of [0, 1].
FAMILIES = {
    "one root": (one_root_ps(skew=0, degree=1, least_alpha=0.15), 0.5),
    "one root, skew": (one_root_ps(skew=1, degree=1, least_alpha=0.15), 0.5),
    "three terms": (two_root_ps(terms=3, degree=1, least_alpha=0.15), 1.0),
    "four terms": (two_root_ps(terms=4, degree=1, least_alpha=0.15), 1.0),
    "five terms": (two_root_ps(terms=5, degree=1, least_alpha=0.05), 1.0),
    **{
        f"{steps} steps, degree {degree}": (
            cubic_ps(steps=steps, degree=degree, least_alpha=0.05),
            5.0,
        )
        for steps, degree in ((0, -1), (1, -1), (3, -1), (0, 1), (2, 0))
    },
}

QUICK_FAMILIES = ("one root", "five terms", "2 steps, degree 0")


@pytest.mark.parametrize(
    "family",
    [
        each if each in QUICK_FAMILIES else pytest.param(each, marks=pytest.mark.slow)
        for each in FAMILIES
    ],
)
def test_where_no_margin_is_negative_the_value_is_a_fraction(family):
    """Point by point, for coefficients at random: what docs/range.md proves."""
    form, size = FAMILIES[family]
    points = spread_points("ps", form.axes, 13, 3)
    random = np.random.default_rng(11)
    start = form.starts()[0]

    def at(fitted):
        call, _ = fitted.margins()

        def three(*x):
            margins = call(*x[:3], jnp.cos(x[3]))
            return functools.reduce(jnp.minimum, margins, x[0]), fitted(*x), fitted.positive(*x)

        return evaluate(traced(fitted, three, form.axes, 3), points).T

    good, bad = 0, 0
    for _ in range(3 if len(start) else 1):
        least, values, positive = at(
            form(jnp.asarray(start + size * random.normal(size=len(start))))
        )
        held = (least >= 0) & (positive > 0)
        assert np.all(values[held] >= -1e-12)
        assert np.all(values[held] <= 1 + 1e-12)
        good, bad = good + held.sum(), bad + np.sum(~held & ~((values >= 0) & (values <= 1)))
    assert good > 1000
    # Margins that are always positive would show nothing; the cubic's are about its root alone.
    assert bad > 0 or form.name == "cubic-ps"


@pytest.mark.parametrize("name", ["best/ps-40", pytest.param("best/ps-21", marks=pytest.mark.slow)])
def test_a_margin_that_is_negative_somewhere_is_found(name):
    form = form_of(load(name))
    c = np.asarray(form.coefficients).copy()
    c[0] -= 20
    worse = type(form)(jnp.asarray(c))
    assert not np.all((values_of(worse) >= 0) & (values_of(worse) <= 1))
    assert certify_range(worse) is None


def test_the_paper_s_forms_have_no_margins():
    for form in PAPER_FORMS.values():
        assert form(jnp.zeros(np.shape(form.coefficient_names()))).margins() is None


def test_the_published_ps_is_no_fraction_everywhere():
    form = form_of(load("published/ps"))
    values = form_values(form, check_reference(type(form), 77)[0])
    assert values.min() < -0.04
    assert values.max() > 1.05
