"""Piecewise linear forms: values as NumPy interpolates, proofs, knots, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import RegularGridInterpolator

from fitting.fit import fit
from fitting.form import traced
from fitting.linearity import linear_parts
from fitting.shapes import piecewise_linear
from integrals import Axis
from programs import evaluate
from tests.fitting.lines import AXIS, LINE, operations
from tests.fitting.toys import TOY


@pytest.mark.parametrize("knots", [2, 9, [1.0, 1.1, 3.0], [1.5, 2.0], [1.0, 1.25, 1.5]])
def test_values_are_interpolated_and_constant_outside_the_knots(knots):
    form = piecewise_linear(LINE, knots, name="p")
    places = np.linspace(1, 3, knots) if isinstance(knots, int) else np.array(knots)
    c = np.random.default_rng(1).normal(size=len(places))
    fitted, eta = form.fitted(c), np.sort(np.append(np.linspace(1, 3, 57), places))
    found = evaluate(traced(fitted, fitted, form.axes), eta[:, None])[:, 0]
    np.testing.assert_allclose(found, np.interp(eta, places, c), atol=1e-14)


def test_knots_follow_the_scale_of_the_axis():
    reference = replace(LINE, axes=(replace(AXIS, lower=0.01, upper=1.0, scale="logarithmic"),))
    form = piecewise_linear(reference, 3, name="p")
    assert form.equation == (
        "ramp(x) = min(max(x, 0), 1); f = c0 + (c1 − c0)·ramp((η − 0.01)/0.09000000000000001) "
        "+ (c2 − c1)·ramp((η − 0.1)/0.9)"
    )


def test_it_is_linear_has_no_pole_and_its_range_is_proven():
    form = piecewise_linear(LINE, 5, name="p")
    parts = linear_parts(form, np.linspace(1, 3, 7)[:, None])
    assert parts is not None
    assert parts.is_linear
    found = fit(form)
    c = np.asarray(found.fitted.coefficients)
    assert found.certificate.bound == np.inf
    assert found.range is not None
    assert (found.range.lower, found.range.upper) == pytest.approx((c.min(), c.max()), rel=1e-3)


def test_a_piece_needs_six_operations_and_less_at_the_ends():
    c = np.random.default_rng(2).normal(size=6)
    # A piece: difference, scale, two limits, size, sum. The first and the last have one limit less.
    assert operations(piecewise_linear(LINE, 6, name="p"), c) == 5 * 6 - 2


@pytest.mark.parametrize(
    ("knots", "message"),
    [
        (1, "p: 1 knots: at least 2 are needed"),
        ([2.0], "p: 1 knots: at least 2"),
        ([2.0, 1.0], r"p: knots \[2.0, 1.0\]: allowed are increasing"),
        ([1.0, np.nan], "allowed are increasing finite"),
        ([1.0, 4.0], r"p: knot 4: allowed are \[1, 3\] of eta"),
    ],
)
def test_bad_knots_are_refused(knots, message):
    with pytest.raises(ValueError, match=message):
        piecewise_linear(LINE, knots, name="p")


@pytest.mark.parametrize("knots", [4, (3, 4), ([0.0, 0.2, 1.0], 5), ([0.1, 0.6], [-0.5, 0, 1.5])])
def test_on_a_grid_of_two_axes_values_are_interpolated_in_both(knots):
    form = piecewise_linear(TOY, knots, name="p")
    each = (knots, knots) if isinstance(knots, int) else knots
    lines = [
        np.linspace(axis.lower, axis.upper, n) if isinstance(n, int) else np.array(n, float)
        for n, axis in zip(each, form.axes, strict=True)
    ]
    c = np.random.default_rng(1).normal(size=[len(line) for line in lines])
    fitted = form.fitted(c.ravel())
    points = np.random.default_rng(2).random((200, 2)) * [1, 3] - [0, 1]
    found = evaluate(traced(fitted, fitted, form.axes), points)[:, 0]
    inside = [np.clip(points[:, k], lines[k][0], lines[k][-1]) for k in range(2)]
    exact = RegularGridInterpolator(lines, c)(np.stack(inside, axis=1))
    np.testing.assert_allclose(found, exact, atol=1e-14)
    assert form.coefficient_names[:2] == ["c00", "c01"]


def test_a_grid_is_fitted_proven_and_the_ramps_of_an_axis_are_computed_once():
    form = piecewise_linear(TOY, (3, 4), name="p")
    found = fit(form)
    assert found.certificate.bound == np.inf
    assert found.solver == "QR"
    inner = piecewise_linear(TOY, ([0.1, 0.4, 0.9], [-0.7, 0.1, 1.2, 1.8]), name="p")
    # Two and three ramps: a difference, a scale and two limits. In each of three rows three
    # products and sums. To join the rows, two differences, products and sums.
    c = np.random.default_rng(3).normal(size=12)
    assert operations(inner, c) == 5 * 4 + 3 * 3 * 2 + 2 * 3


def test_wrong_numbers_of_axes_and_endless_ones_are_refused():
    with pytest.raises(ValueError, match="p: 3 knots: allowed are one number, or those of x, y"):
        piecewise_linear(TOY, (3, 4, 5), name="p")
    endless = replace(LINE, axes=(Axis("x", 0.0, np.inf),))
    with pytest.raises(ValueError, match="allowed is a finite domain"):
        piecewise_linear(endless, 3, name="p")
    assert piecewise_linear(endless, [0.0, 1.0, 4.0], name="p").size == 3
