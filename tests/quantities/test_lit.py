"""The quantity E_lit, which a problem file offers: its form, the arguments of its code, its fit."""

from pathlib import Path

import numpy as np
import pytest

from fitting.fit import fit
from quantities.fuzz.lit_forms import AREA_RATIO
from quantities.loader import load_problems
from quantities.registry import unregister
from shading import lit_fraction
from shading.fuzz.ambient import LIT_FRACTION_CONSTANTS

EXAMPLE = Path(__file__).parents[2] / "examples" / "lit_fraction.py"


@pytest.fixture(scope="module")
def quantity():
    (found,) = load_problems(str(EXAMPLE))
    yield found
    unregister(found.name)


def test_form_is_the_formula_of_the_ambient_model(quantity):
    assert quantity.name == "lit"
    assert quantity.default is AREA_RATIO
    point = (0.4, 0.7, 0.9, 2.0)
    (columns,) = quantity.calling.columns(np.array([point]))
    cos_vt, scattered = columns
    expected = lit_fraction(scattered, cos_vt, point[0])
    assert abs(AREA_RATIO(np.array(LIT_FRACTION_CONSTANTS), *point) - expected) < 1e-14


def test_limits():
    for alpha in (1.0, 1e-6):
        point = (alpha, 0.7, 0.9, 2.0)
        scattered = AREA_RATIO.inputs(*point)[1]
        assert abs(AREA_RATIO(np.array([1.1, 0.7]), *point) - (1 - scattered)) < 1e-5


@pytest.mark.slow
def test_constants_are_those_of_the_fit():
    """The fit is proven to have no pole, with v·t and P_s anywhere in their ranges."""
    made = fit(AREA_RATIO)
    assert made.converged
    assert made.certificate.bound > 0
    found = np.asarray(made.fitted.coefficients)
    np.testing.assert_allclose(found, LIT_FRACTION_CONSTANTS, rtol=0, atol=1.5e-4)
