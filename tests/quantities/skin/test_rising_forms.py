"""Rising forms of the light on skin: what their margins are, and what their tables reach."""

import re
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from coefficients.catalogue import resolve
from coefficients.exported_code import programs_of
from coefficients.packaged import names_of_best
from fitting import form_values
from fitting.proofs.range_proof import certify_range
from integrals.skin.references import CYLINDER
from programs import evaluate
from quantities.skin.hyperbola_forms import MOST_CURVATURE
from quantities.skin.rising_forms import rising_form

TERMS = ((0, 1), (0, 2), (1, 1), (2, 2), (3, 1), (4, 1), (4, 2), (5, 0), (5, 1))
FORM = rising_form(CYLINDER[0], narrow=0.3, wide=0.8, numerator=TERMS, below=1)
C = np.array([0.1, -0.3, 0.2, -0.1, 0.4, -0.2, 0.5, -0.6, 0.3, 0.7])
# The largest errors that rising tables reach, off the grid
GOALS = {"red": 0.00134, "green": 0.00037, "blue": 0.000116}
TABLES = [name for name in names_of_best() if name.endswith("-63-rising")]


def test_the_margins_are_the_derivative_and_the_ends_times_the_denominator():
    """By automatic differentiation of the form, at the points that y and s stand for."""
    slope, m = jax.grad(FORM, 1), MOST_CURVATURE
    c = jnp.asarray(C)

    def rise(cosine, k, divisor):
        return float(slope(c, cosine, k)) * (1 + C[-1] * k) / divisor

    for y, s in ((0.6, 0.37), (1.0, 1.0), (0.05, 0.9)):
        k = m * y
        expected = [
            rise(-y, s * y * k, m * s * y * y),
            rise(-s * y, s * y * k, m * y * y),
            rise(-s * y, k, m),
            rise(y, s * k, 1),
            rise(s * y, k, 1),
            float(FORM(c, -1.0, k)) * (1 + C[-1] * k) / k,
            (1 - float(FORM(c, 1.0, k))) * (1 + C[-1] * k) / k,
        ]
        np.testing.assert_allclose(FORM.proofs.margins(c, y, s), expected, rtol=1e-8, atol=1e-10)


def values(name: str, rows: int = 401) -> np.ndarray:
    """Return the values of a table (cosines, curvatures) on a grid, with κ near 0 too."""
    c = np.linspace(-1, 1, rows)
    k = np.concatenate([[0.0], np.geomspace(1e-4, MOST_CURVATURE, 25)])
    at = np.stack(np.meshgrid(c, k, indexing="ij"), axis=-1).reshape(-1, 2)
    return np.asarray(form_values(resolve(name).require_fitted(), at)).reshape(rows, -1)


@pytest.mark.parametrize("name", TABLES, ids=[name[10:-10] for name in TABLES])
def test_a_rising_table_rises_and_stays_between_zero_and_one(name):
    found = values(name)
    # What rounding of values below 1 may lose
    assert np.diff(found, axis=0).min() > -5e-16
    assert found.min() > -1e-16
    assert found.max() <= 1
    table = resolve(name).require_table()
    assert table.certificates.range == [0.0, 1.0]
    assert table.errors.off_grid.max < GOALS[name.split("-")[2]]
    # Without the constraints the values fall.
    assert np.diff(values(name.removesuffix("-rising")), axis=0).min() < -1e-7


@pytest.mark.parametrize("name", TABLES, ids=[name[10:-10] for name in TABLES])
def test_exported_code_in_float_falls_by_rounding_only(name):
    """Rounding moves a value below one by some 6e-8; docs/skin.md states 8e-8."""
    (program,) = programs_of(resolve(name))
    c = np.linspace(-1, 1, 2001)
    k = np.concatenate([[0.0, 1e-30], np.geomspace(1e-6, MOST_CURVATURE, 30)])
    at = np.stack(np.meshgrid(k, c, indexing="ij")[::-1], axis=-1).reshape(-1, 2)
    found = np.ravel(evaluate(program, at, np.float32)).astype(float).reshape(len(k), -1)
    assert 0 <= found.min() <= found.max() <= 1
    assert (np.maximum.accumulate(found, axis=1) - found).max() < 1.2e-7


PAGE = (Path(__file__).parents[3] / "docs" / "skin.md").read_text(encoding="utf-8")


def test_the_page_has_the_errors_of_the_tables():
    """To half a unit of the digits that it has."""
    rows = re.findall(r"^\| `(best/skin-\S+)` \| (\d\.\d\de-\d\d) \| (\S+) \|", PAGE, re.M)
    assert sorted(name for name, _, _ in rows) == sorted(
        name for name in names_of_best() if name.startswith(("best/skin-c", "best/skin-s"))
    )
    for name, largest, second in rows:
        table = resolve(name).require_table()
        assert f"{table.errors.off_grid.max:.2e}" == largest
        expected = table.shape["narrow"] if "rising" in name else table.certificates.least_error
        assert float(second) == pytest.approx(expected, abs=0.005e-4 if expected < 0.01 else 0)


def test_a_form_that_falls_somewhere_is_not_proven():
    fitted = resolve(TABLES[0]).require_fitted()
    assert certify_range(fitted) is not None
    names = fitted.form.coefficient_names
    changed = fitted.constants.copy()
    # a11 is the slope in the shadow of flat skin, by κ.
    changed[names.index("a11")] -= 0.01
    assert certify_range(fitted.form.fitted(changed)) is None
