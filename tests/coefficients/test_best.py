"""What every table states of itself, measured and proven anew; what README promises of the best.

Exact values are evaluated so fast that this belongs to the default tests, but for a few of the
slowest. A shorter check of each table shows that a single changed coefficient is noticed.
"""

import functools
import itertools
import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from coefficients.catalogue import Entry, entries, resolve
from coefficients.exported_code import operations_of
from coefficients.packaged import names_of_best
from fitting import FittedForm, form_values, judge
from fitting.fit import ENOUGH
from fitting.form import traced
from fitting.points.grids import sobol_points
from fitting.points.scattered import judging_points, scattered_points
from fitting.proofs.local_optimality import local_optimality
from fitting.proofs.pole_proof import certify_denominators, proof_axes
from fitting.proofs.range_proof import ROUNDING as ROUNDING_OF_PROOF
from fitting.proofs.range_proof import TIGHTNESS, certify_range
from fitting.solvers.extrema import worst_points
from integrals import REFERENCES
from integrals.reference import Axis, box_of
from programs import evaluate, subprogram
from programs.bounding.denominators import operands
from programs.toolchains.verification import corners

BEST = names_of_best()
TABLES = [entry.name for entry in entries() if entry.kind in ("best", "refitted")]
WITH_COEFFICIENTS = [name for name in TABLES if resolve(name).require_table().size]


def slow_for(*some: str) -> list:
    """Return the names of all tables, of which some take seconds and are left to the slow tests."""
    return [pytest.param(n, marks=pytest.mark.slow) if n in some else n for n in TABLES]


# The short check has points of its own: a seed, and 2⁸ uniform ones before others.
SEED, EXPONENT = 20240229, 8
# Values near one are rounded by a few units in the last place.
ROUNDING = 2e-15
# An error that is not proven but searched for may be found larger by so much.
SEARCHED = 1.5e-3
# The mean square of a sample is within so many of its own standard errors of the stated one.
STANDARD_ERRORS = 5.0


@functools.cache
def sample(name: str, axes: tuple[Axis, ...]) -> tuple[np.ndarray, np.ndarray]:
    """Return points, and exact values: first 2^EXPONENT uniform ones, then others and corners."""
    reference = REFERENCES[name]
    uniform = sobol_points(axes, EXPONENT, SEED)
    scattered = scattered_points(reference, axes, EXPONENT, SEED + 1)
    points = np.concatenate([uniform, scattered, corners(axes)])
    return points, reference.values(points)


@functools.cache
def exact_at(name: str, where: tuple[float, ...], axes: tuple[Axis, ...]) -> float:
    """Return the exact value at a point, as the table's errors were measured.

    The rule for R depends on the least α of all points: a corner with this α is evaluated too.
    """
    both = np.array([[axis.lower for axis in axes], where])
    return float(REFERENCES[name].values(both)[1])


def faults(fitted: FittedForm, entry: Entry) -> Iterator[str]:
    """Yield which of a table's statements about its errors and range do not hold for a form.

    What is quickly checked comes first.
    """
    table, name = entry.require_table(), entry.problem.name
    stated = table.errors.off_grid
    for each in (stated, table.errors.on_grid):
        where = tuple(each.where[axis.name] for axis in fitted.axes)
        (value,) = form_values(fitted, np.array([where]))
        apart = abs(value - exact_at(name, where, fitted.axes))
        if apart != pytest.approx(each.max, rel=1e-9, abs=ROUNDING):
            yield f"the error at a worst point is {apart}, not {each.max}"
    points, exact = sample(name, fitted.axes)
    values = form_values(fitted, points)
    error = np.abs(values - exact)
    searched = 1e-9 if table.certificates.largest_error else SEARCHED
    if not error.max() <= stated.max * (1 + searched) + ROUNDING:
        yield f"an error is {error.max()}, above the largest, {stated.max}"
    square = error[: 2**EXPONENT] ** 2
    tolerance = STANDARD_ERRORS * np.std(square) / np.sqrt(len(square))
    if not abs(square.mean() - stated.rms**2) <= tolerance:
        yield f"the rms of a sample is {square.mean() ** 0.5}, not {stated.rms}"
    bounds = table.certificates.range
    if bounds is not None and not bounds[0] <= values.min() <= values.max() <= bounds[1]:
        yield f"values from {values.min()} to {values.max()} are not in {bounds}"
    points, exact = judging_points(fitted.form)
    rms = np.sqrt(np.mean((form_values(fitted, points) - exact) ** 2))
    if rms != pytest.approx(stated.rms, rel=1e-9):
        yield f"the rms is {rms}, not {stated.rms}"


def is_noticed(fitted: FittedForm, entry: Entry) -> bool:
    return next(faults(fitted, entry), None) is not None


# These take 7 s each.
SLOW_TO_MEASURE = ("best/r-40-wide", "ggx-scale", "ggx-bias")


@pytest.mark.parametrize("name", slow_for(*SLOW_TO_MEASURE))
def test_a_table_has_the_errors_and_the_range_that_it_states(name):
    entry = resolve(name)
    assert list(faults(entry.require_fitted(), entry)) == []
    where = entry.require_table().errors.off_grid.where
    assert all(axis.contains(where[axis.name]) for axis in entry.axes)


# R of low α takes as long as all others together, and its rms is checked above.
@pytest.mark.parametrize("name", slow_for("best/r-40-wide"))
def test_a_table_is_measured_anew(name):
    entry = resolve(name)
    errors, stated = judge(entry.require_fitted()), entry.require_table().errors.off_grid
    assert errors.rms == pytest.approx(stated.rms, rel=1e-9)
    assert errors.points == stated.points
    proven = entry.require_table().certificates.largest_error
    if proven is None:
        assert errors.largest == pytest.approx(stated.max, rel=1e-9)
    else:
        # The proof may have found a larger error than the search of a fit.
        assert 0.9 * stated.max < errors.largest <= stated.max * (1 + 1e-9)
        assert proven.lower <= stated.max * (1 + 1e-9)
        assert stated.max <= proven.upper


@pytest.mark.parametrize("name", TABLES)
def test_the_largest_error_is_not_overstated(name):
    """On the sample errors come near the largest where that is made least."""
    entry = resolve(name)
    points, exact = sample(entry.problem.name, entry.axes)
    error = np.abs(form_values(entry.require_fitted(), points) - exact).max()
    stated = entry.require_table().errors.off_grid.max
    # Least squares leaves single large errors, and the closed form few, near α = 0.05.
    goal = entry.require_table().goal
    least = 0.7 if goal is not None and entry.require_table().size else 0.05
    assert error > least * stated


@pytest.mark.parametrize("name", TABLES)
def test_no_denominator_at_a_sample_is_below_the_stated_bound(name):
    entry = resolve(name)
    fitted, stated = entry.require_fitted(), entry.require_table().certificates
    value, axes = fitted.form.proofs.value or fitted.form, proof_axes(fitted.form)
    program = traced(fitted, lambda *point: value(fitted.constants, *point), axes)
    divisors = operands(program, "div", 1)
    if stated.denominator_bound is None:
        assert divisors == []
        return
    points = np.concatenate([sobol_points(axes, 10, SEED), np.array(list(_ends(axes)))])
    least = evaluate(subprogram(program, divisors), points).min()
    assert least >= stated.denominator_bound
    assert stated.denominator_bound >= 1e-6


def _ends(axes):
    return itertools.product(*box_of(axes))


@pytest.mark.parametrize("name", BEST)
def test_coefficients_of_the_best_tables_are_float32(name):
    c = resolve(name).require_fitted().constants
    np.testing.assert_array_equal(c, c.astype(np.float32).astype(float))


# The forms that are quotients of linear functions, so that the least error is bounded from below.
QUOTIENTS = (
    *("best/q-", "best/r-", "best/ggx-directional-albedo-", "best/ggx-average-albedo-"),
    *("best/sggx-filter-", "best/skin-"),
)
# A proven lower bound is at most so far below the largest error, as README says.
GAP = 0.005
# Fits of forms with a proven lower bound that are further above it.
NOT_LEAST = {
    "best/skin-cylinder-green-63": 0.075,
    # Its only coefficient is rounded to float32.
    "best/skin-band-1-blue-7": 0.008,
}
# The bound of a form with constraints is that without them. So this is what they cost, by channel.
CONSTRAINED = {"red": 0.38, "green": 0.51, "blue": 0.4}
# Fits whose largest error elsewhere is further above that at their own points.
NOT_SETTLED = {"best/ps-11": 0.006, "best/ggx-scale-83": 0.006, "best/ggx-bias-93": 0.012}
# A change of one coefficient by one per cent can be undone, to first order.
UNDONE = 0.01


@pytest.mark.parametrize("name", TABLES)
def test_a_best_table_says_how_near_it_is_to_the_best_coefficients(name):
    """By a lower bound of the largest error where its form has one, or else to first order."""
    table = resolve(name).require_table()
    least, local = table.certificates.least_error, table.certificates.local_optimality
    of_best, bounded = name in BEST and table.size > 0, name.startswith(QUOTIENTS)
    assert (least is not None) == (of_best and bounded)
    assert (local is not None) == (of_best and not bounded)
    if least is not None:
        largest = table.errors.off_grid.max
        assert least <= table.errors.on_grid.max * (1 + 1e-9)
        rising = name.endswith("-rising")
        gap = CONSTRAINED[name.split("-")[2]] if rising else NOT_LEAST.get(name, GAP)
        assert (1 - gap) * largest < least <= largest * (1 + 1e-9)
    if local is not None:
        # At the points of the fit, where the largest error may be less than elsewhere.
        errors = table.errors
        gain = 1 - (1 - local.decrease) * errors.on_grid.max / errors.off_grid.max
        assert gain < NOT_SETTLED.get(name, GAP)
        # Zero in the convex hull of n gradients of m numbers: n ≤ m + 1.
        assert 2 <= local.extrema <= table.size + 1


def decrease(fitted: FittedForm, entry: Entry) -> float:
    """Return what small changes of coefficients may gain, at points that no fit used."""

    def size(x: np.ndarray) -> np.ndarray:
        return np.abs(form_values(fitted, x) - fitted.reference.values(x))

    axes, errors = fitted.axes, entry.require_table().errors
    known = [[each.where[a.name] for a in axes] for each in (errors.on_grid, errors.off_grid)]
    points = np.concatenate([scattered_points(fitted.reference, axes, 12, SEED), known])
    # Over four axes, one search from the worst point of each cell misses many maxima.
    for seed in range(8 if len(axes) > 2 else 1):
        points = np.concatenate([points, scattered_points(fitted.reference, axes, 12, seed)])
        found = worst_points(size, points, size(points), axes, seed)
        points = np.concatenate([points, found])
    # The number uses the worst points: of those that are close together, only the worst is kept.
    points = points[np.argsort(-size(points))]
    lower, upper = box_of(axes).T
    cells = np.round(100 * (points - lower) / (upper - lower))
    points = points[np.sort(np.unique(cells, axis=0, return_index=True)[1])]
    bounded = entry.require_table().goal.bounded
    measured = local_optimality(fitted, points, fitted.reference.values(points), bounded)
    return measured.decrease


# Many maxima hold these down, and a search that begins anew misses some. Their fits found them.
UNSEEN = ("best/ps-11", "best/ps-21", "best/ps-25")
LOCAL = [
    name if name == "best/g-9" else pytest.param(name, marks=pytest.mark.slow)
    for name in WITH_COEFFICIENTS
    if name in BEST and not name.startswith(QUOTIENTS) and name not in UNSEEN
]


@pytest.mark.parametrize("name", LOCAL)
def test_only_the_coefficients_of_a_table_are_a_local_optimum(name):
    entry = resolve(name)
    fitted = entry.require_fitted()
    assert decrease(fitted, entry) < NOT_SETTLED.get(name, GAP)
    changed = np.ravel(fitted.constants).copy()
    changed[0] *= 1.01
    assert decrease(fitted.form.fitted(changed), entry) > UNDONE


def test_which_tables_are_not_proven_to_be_within_the_codomain():
    """README states this too."""
    without = [name for name in TABLES if not resolve(name).require_table().certificates.range]
    skin = [name for name in TABLES if "skin-" in name and "skin-band-" not in name]
    skin = [name for name in skin if not name.endswith("-rising")]
    assert sorted(without) == sorted(
        ["ggx-bias", "ggx-directional-albedo", "ggx-scale", "ps", *skin]
    )
    for name in TABLES:
        low, high = resolve(name).problem.reference.codomain
        bounds = resolve(name).require_table().certificates.range or [low, high]
        assert low - ROUNDING_OF_PROOF <= bounds[0] <= bounds[1] <= high + ROUNDING_OF_PROOF


# The checks above can fail.


@pytest.mark.parametrize("factor", [1.02, 0.999])
@pytest.mark.parametrize("name", WITH_COEFFICIENTS)
def test_a_changed_coefficient_is_noticed(name, factor):
    """Each single coefficient of a table, scaled by 2 %, or by a thousandth."""
    entry = resolve(name)
    form, constants = entry.require_fitted().form, np.ravel(entry.require_fitted().constants)
    unnoticed = []
    # A smaller coefficient changes values by less than 1e-10: it is as good as none.
    for index in np.flatnonzero(np.abs(constants) > 2e-7):
        changed = constants.copy()
        changed[index] *= factor
        if not is_noticed(form.fitted(changed), entry):
            unnoticed.append(int(index))
    assert unnoticed == []


@pytest.mark.parametrize("name", TABLES)
def test_a_wrong_statement_is_noticed(name):
    """A stated error that is too small or too large by a millionth, and an rms that is doubled."""
    entry = resolve(name)
    table = entry.require_table()
    off_grid = table.errors.off_grid
    # Of errors near those of the exact values, less is known.
    part = max(1e-6, 1e-12 / off_grid.max)
    for change in (
        {"max": off_grid.max * (1 - part)},
        {"max": off_grid.max * (1 + part)},
        {"rms": off_grid.rms * 2},
    ):
        errors = table.errors.model_copy(update={"off_grid": off_grid.model_copy(update=change)})
        wrong = Entry(name, entry.kind, entry.problem, table.model_copy(update={"errors": errors}))
        assert is_noticed(entry.require_fitted(), wrong)


# What README promises of the best tables


@functools.cache
def operations(name: str) -> int:
    return operations_of(resolve(name))


def largest(name: str) -> float:
    return resolve(name).require_table().errors.off_grid.max


@functools.cache
def published_largest(quantity: str) -> float:
    return judge(resolve(f"published/{quantity}").require_fitted()).largest


# The operations of clamps that keep values finite and within the codomain outside the domain: of
# density from below; of v·n; of u·n, u·t and P_s. The form with one root also clamps its radicand.
SAFETY = {"q": 1, "g": 3, "r": 0, "ps": 6}


def of(quantity: str) -> list[str]:
    return [name for name in BEST if resolve(name).problem.name == quantity]


README = (Path(__file__).parents[2] / "README.md").read_text(encoding="utf-8")
# | `best/q-4` | 4 … | 5 | 7.0e-4 | 13 | … |
ROWS = re.findall(
    r"^\| `(best/\S+)` \| (\d+)[^|]*\|[^|]*\| ([\d.e-]+) \| ([\d,.]+|—) \|", README, re.M
)


def test_readme_lists_every_best_table():
    assert sorted(row[0] for row in ROWS) == sorted(BEST)


@pytest.mark.parametrize(("name", "cost", "error", "ratio"), ROWS)
def test_readme_states_the_cost_and_the_largest_error(name, cost, error, ratio):
    assert int(cost) == operations(name)
    # As many digits as are shown.
    shown = len(error.partition("e")[0].replace(".", "").lstrip("0"))
    assert float(f"{largest(name):.{shown - 1}e}") == float(error)


@pytest.mark.parametrize(
    "quantity", ["q", "g", "r", "ps", "ggx-directional-albedo", "ggx-scale", "ggx-bias"]
)
def test_readme_states_by_what_factor_the_largest_error_is_smaller(quantity):
    for name, _, _, ratio in ROWS:
        if name in of(quantity):
            expected = published_largest(quantity) / largest(name)
            assert float(ratio.replace(",", "")) == pytest.approx(expected, rel=0.05)


@pytest.mark.parametrize("name", BEST)
def test_a_table_is_named_by_its_quantity_and_its_cost(name):
    entry = resolve(name)
    assert name == f"best/{entry.require_table().name}"
    quantity = entry.problem.name
    assert name.startswith(f"best/{quantity}-")
    number = name.removeprefix(f"best/{quantity}-").split("-")[0]
    # The number leaves out the clamps that only keep values finite outside the domain. For GGX all
    # clamps are counted.
    safety = SAFETY.get(quantity, 0) + (entry.require_fitted().form.name == "one-root-ps")
    assert int(number) == operations(name) - safety


@pytest.mark.parametrize("quantity", ["q", "g", "r", "ps"])
def test_one_table_is_better_for_no_more_operations_and_one_ten_times_better(quantity):
    cost, error = operations(f"published/{quantity}"), published_largest(quantity)
    assert any(operations(name) <= cost and largest(name) < 0.9 * error for name in of(quantity))
    assert any(largest(name) <= 0.1 * error for name in of(quantity))


@pytest.mark.parametrize(
    ("quantity", "budget", "most"),
    [
        ("q", 10, 2e-5),
        ("g", 16, 5e-3),
        ("r", 36, 1e-4),
        ("ps", 19, 0.067),
        ("ps", 31, 0.0155),
        ("ps", 46, 2.5e-3),
    ],
)
def test_an_error_is_reached_within_a_budget(quantity, budget, most):
    assert any(operations(name) <= budget and largest(name) <= most for name in of(quantity))


def test_tables_for_the_whole_domain_reach_upright_fibres_and_low_alpha():
    for quantity, most in (("ps", 5e-3), ("r", 1e-4)):
        wide = [name for name in of(quantity) if resolve(name).axes[0].lower <= 0.05]
        assert min(largest(name) for name in wide) <= most
        for name in wide:
            assert resolve(name).require_table().arguments[1].domain == [0.0, np.pi / 2]


@pytest.mark.parametrize("quantity", ["q", "g", "r", "ps"])
def test_more_operations_never_buy_a_larger_error(quantity):
    # Of one domain: a wider one costs error.
    narrow = [name for name in of(quantity) if not name.endswith("-wide")]
    # Those with more structure, or no exponential, are kept for that.
    ranked = [n for n in sorted(narrow, key=operations) if n[5:] not in ("g-19", "q-5")]
    errors = [largest(name) for name in ranked]
    assert sorted(errors) == sorted(set(errors))
    for one, other in itertools.pairwise(ranked):
        assert operations(one) == operations(other) or largest(other) < largest(one)


# Proven anew

SLOWEST_PROOFS = ("best/ps-21", "best/ps-25", "best/ps-40", "best/ps-40-wide", "best/ps-49-wide")


@pytest.mark.parametrize("name", slow_for(*SLOWEST_PROOFS))
def test_a_table_is_certified_anew(name):
    assert certify_denominators(resolve(name).require_fitted(), ENOUGH).holds


@pytest.mark.parametrize("name", slow_for("best/ps-11", *SLOWEST_PROOFS))
def test_the_range_of_a_table_is_proven_anew(name):
    entry = resolve(name)
    fitted, stated = entry.require_fitted(), entry.require_table().certificates.range
    points = scattered_points(fitted.reference, fitted.axes, 13, 5)
    found, values = certify_range(fitted), form_values(fitted, points)
    low, high = entry.problem.reference.codomain
    if found is None:
        assert stated is None
        assert values.min() < low or values.max() > high
        return
    assert stated == pytest.approx([found.lower, found.upper], abs=TIGHTNESS)
    assert found.lower <= values.min() <= values.max() <= found.upper
    assert low - ROUNDING_OF_PROOF <= found.lower <= found.upper <= high + ROUNDING_OF_PROOF
    if fitted.form.proofs.margins is None:
        assert values.min() - found.lower < 3 * TIGHTNESS
        assert found.upper - values.max() < 3 * TIGHTNESS


@pytest.mark.parametrize("name", ["best/ps-40", pytest.param("best/ps-21", marks=pytest.mark.slow)])
def test_a_range_that_does_not_hold_is_not_proven(name):
    """With a coefficient far off, a margin of the proof is negative and values leave [0, 1]."""
    fitted = resolve(name).require_fitted()
    worse = fitted.constants.copy()
    worse[0] -= 20
    changed = fitted.form.fitted(worse)
    points = scattered_points(fitted.reference, fitted.axes, 10, 5)
    values = form_values(changed, points)
    assert not np.all((values >= 0) & (values <= 1))
    assert certify_range(changed) is None
