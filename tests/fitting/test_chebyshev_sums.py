"""Chebyshev sums: values by an independent evaluation, high degrees, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.polynomial import chebyshev as numpy_chebyshev

from fitting.fit import fit
from fitting.form import traced
from fitting.shapes import chebyshev
from integrals import Axis
from programs import evaluate
from tests.fitting.lines import LINE, operations
from tests.fitting.toys import TOY


@pytest.mark.parametrize("degree", [0, 1, 2, 7, 40])
def test_clenshaw_agrees_with_numpy(degree):
    form = chebyshev(LINE, degree, name="c")
    c = np.random.default_rng(1).normal(size=degree + 1)
    fitted, eta = form.fitted(c), np.linspace(1, 3, 41)
    found = evaluate(traced(fitted, fitted, form.axes), eta[:, None])[:, 0]
    # Rounding grows with the degree: by the sum of |c|, times a few units in the last place.
    allowed = 20 * np.finfo(float).eps * np.abs(c).sum() * (degree + 1)
    np.testing.assert_allclose(found, numpy_chebyshev.chebval(eta - 2, c), atol=allowed, rtol=0)


def test_the_sum_over_two_axes_is_that_of_all_products():
    form = chebyshev(TOY, (2, 3), name="c")
    c = np.random.default_rng(2).normal(size=12)
    x, y = 0.3, -0.7
    expected = numpy_chebyshev.chebval2d(2 * x - 1, (2 * y - 1) / 3, c.reshape(3, 4))
    assert float(form(c, x, y)) == pytest.approx(float(expected), rel=1e-13)
    assert form.coefficient_names[:5] == ["c00", "c01", "c02", "c03", "c10"]
    assert chebyshev(TOY, 1, name="c").equation == (
        "t1 = 2·x − 1; t2 = (2·y − 1)/3; f = c00 + c01·t2 + c10·t1 + c11·t1·t2"
    )


def test_a_step_is_a_product_and_two_sums():
    form = chebyshev(LINE, 10, name="c")
    assert operations(form, np.random.default_rng(3).normal(size=11)) == 3 * 10 + 1


@pytest.mark.slow
def test_a_high_degree_reaches_rounding():
    found = fit(chebyshev(LINE, 40, name="c"), nodes=65)
    assert found.solver == "QR"
    assert found.off_grid.largest < 1e-14
    assert found.certificate.holds


def test_what_has_no_interval_or_degree_is_refused():
    endless = replace(LINE, axes=(Axis("eta", 1.0, np.inf),))
    with pytest.raises(ValueError, match=r"c: eta in \[1, ∞\): allowed is a finite domain"):
        chebyshev(endless, 3, name="c")
    for degrees in (-1, (1,), (1, 2, 3), (-1, 2)):
        with pytest.raises(ValueError, match=r"c: degrees = .*: allowed are whole numbers ≥ 0 for"):
            chebyshev(TOY, degrees, name="c")
