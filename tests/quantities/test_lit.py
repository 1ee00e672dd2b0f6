"""The quantity E_lit: its form, the arguments of its code, and its fit."""

import numpy as np
import pytest

from fitting.fit import fit
from quantities.fuzz.lit import LIT
from quantities.fuzz.lit_forms import AREA_RATIO
from shading import lit_fraction
from shading.fuzz.ambient import LIT_FRACTION_CONSTANTS


def test_form_is_the_formula_of_the_ambient_model():
    assert LIT.name == "lit"
    assert LIT.default is AREA_RATIO
    point = (0.4, 0.7, 0.9, 2.0)
    (columns,) = LIT.calling.columns(np.array([point]))
    cos_vt, scattered = columns
    expected = lit_fraction(scattered, cos_vt, point[0])
    assert abs(AREA_RATIO(np.array(LIT_FRACTION_CONSTANTS), *point) - expected) < 1e-14


def test_limits():
    for alpha in (1.0, 1e-6):
        point = (alpha, 0.7, 0.9, 2.0)
        scattered = AREA_RATIO.inputs(*point)[1]
        assert abs(AREA_RATIO(np.array([1.1, 0.7]), *point) - (1 - scattered)) < 1e-5


@pytest.mark.slow
def test_fit():
    """The fit is proven to have no pole, with v·t and P_s anywhere in their ranges.

    0.0079 was measured. The largest errors are at grazing views along fibres with α = 0.05.
    """
    made = fit(AREA_RATIO)
    assert made.converged
    assert made.certificate.bound > 0
    assert made.off_grid.rms < 0.0085
