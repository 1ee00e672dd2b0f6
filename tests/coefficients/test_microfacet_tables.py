"""What the tables of GGX reach: errors, costs, and that B is proven to be below E."""

import numpy as np
import pytest

from coefficients.catalogue import resolve
from coefficients.exported_code import operations_of
from coefficients.packaged import names_of_best
from fitting import form_values, judge
from fitting.form import traced
from integrals import GGX_AVERAGE_ALBEDO
from integrals.reference import box_of
from programs.bounding.branch_and_bound import BranchAndBound
from programs.bounding.denominators import NOWHERE_NEGATIVE, within
from quantities.microfacet.split_forms import ALBEDO_COEFFICIENTS

E = "best/ggx-directional-albedo-57"


def of(quantity: str) -> list[str]:
    return [name for name in names_of_best() if name.startswith(f"best/{quantity}-")]


def largest(name: str) -> float:
    return resolve(name).require_table().errors.off_grid.max


@pytest.mark.parametrize(
    ("quantity", "most", "budget"),
    [
        # No more operations than the published E has.
        ("ggx-directional-albedo", 2e-3, 83),
        ("ggx-directional-albedo", 1e-3, 83),
        ("ggx-bias", 2e-3, 1000),
        ("ggx-average-albedo", 5e-5, 20),
        ("ggx-average-albedo", 1.1e-5, 20),
    ],
)
def test_an_error_is_reached_within_a_budget(quantity, most, budget):
    assert any(
        largest(name) <= most and operations_of(resolve(name)) <= budget for name in of(quantity)
    )


def test_an_average_without_a_logarithm_reaches_its_error():
    assert any(largest(n) <= 5e-5 for n in of("ggx-average-albedo") if not n.endswith("-log"))


@pytest.mark.slow
def test_the_published_e_has_so_many_operations_and_such_an_error():
    entry = resolve("published/ggx-directional-albedo")
    assert operations_of(entry) == 83
    assert judge(entry.require_fitted()).largest == pytest.approx(0.0924, rel=1e-2)


def test_the_e_of_the_tables_of_a_and_b_is_that_of_a_best_table():
    assert resolve(E).require_fitted().constants.tolist() == list(ALBEDO_COEFFICIENTS)


@pytest.mark.parametrize("name", ["best/ggx-bias-80", "best/ggx-scale-83"])
def test_a_and_b_are_proven_to_be_below_their_e(name):
    part, whole = resolve(name).require_fitted(), resolve(E).require_fitted()
    assert resolve(name).require_table().certificates.range == [0.0, 1.0]
    v_and_t = part.form.proofs.margins
    program = traced(part, lambda *p: v_and_t(part.constants, *p)[1], part.axes)
    found = BranchAndBound().bound_output(
        program, box_of(part.axes), NOWHERE_NEGATIVE, within(NOWHERE_NEGATIVE)
    )
    # T − V is nowhere negative, so t⁵ and 1 − t⁵ are in [0, 1].
    assert found.lower >= 0
    at = np.random.default_rng(3).random((500, 2)) * [1, 0.99] + [0, 0.01]
    assert np.all(form_values(part, at) <= form_values(whole, at))


@pytest.mark.parametrize(
    ("name", "most"),
    [
        ("best/ggx-average-albedo-13-log", 4.8e-3),
        ("best/ggx-average-albedo-17-log", 3.0e-4),
        ("best/ggx-average-albedo-20-log", 2.7e-4),
    ],
)
def test_the_relative_error_of_the_lost_energy_is_bounded_for_every_alpha(name, most):
    """Energy compensation divides by 1 − E_avg, which goes to 0 with α."""
    fitted = resolve(name).require_fitted()
    alpha = np.geomspace(0.001, 1, 400)[:, None]
    lost = 1 - GGX_AVERAGE_ALBEDO.values(alpha)
    relative = np.abs((1 - form_values(fitted, alpha) - lost) / lost)
    assert relative.max() <= most
    # Below the domain it becomes smaller.
    assert relative[0] < 0.1 * most
