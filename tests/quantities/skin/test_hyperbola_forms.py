"""Forms of the light on skin: the formula, what is built in, and what the best tables reach."""

import numpy as np
import pytest

from coefficients.catalogue import resolve
from coefficients.packaged import names_of_best
from fitting import form_values
from fitting.linearity import linear_parts
from integrals.skin.references import CYLINDER, SKIN_REFERENCES
from quantities.skin.hyperbola_forms import candidates, hyperbola_form

TERMS = ((0, 1), (1, 2), (2, 1), (3, 3), (4, 1), (5, 0))
FORM = hyperbola_form(CYLINDER[0], narrow=0.3, wide=0.8, numerator=TERMS, below=1)
C = np.array([0.1, 0.2, -0.3, 0.4, 0.5, -0.6, 0.7])
# The largest errors that the tables are to reach, off the grid
GOALS = {"red": 1.5e-3, "green": 2e-4, "blue": 1.5e-4}


def scattered(count: int) -> np.ndarray:
    rng = np.random.default_rng(4)
    return np.stack([rng.uniform(-1, 1, count), 0.5 * rng.random(count)], axis=1)


def test_the_form_is_its_equation():
    c, k = scattered(100).T
    q = np.sqrt(c**2 + 0.09 * k**2)
    p = np.sqrt(c**2 + 0.64 * k**2) - q
    n = 0.1 * k + 0.2 * k**2 * c - 0.3 * k * c**2 + 0.4 * k**3 * c**4 + 0.5 * k * q - 0.6 * p
    expected = (c + q) / 2 + n / (1 + 0.7 * k)
    np.testing.assert_allclose(form_values(FORM.fitted(C), scattered(100)), expected, rtol=1e-12)


def test_flat_skin_shows_the_cosine_whatever_the_coefficients():
    c = np.linspace(-1, 1, 41)
    at = np.stack([c, np.zeros(41)], axis=1)
    np.testing.assert_array_equal(form_values(FORM.fitted(C), at), np.maximum(c, 0))


@pytest.mark.parametrize("term", [(0, 0), (4, 0), (6, 1)])
def test_terms_that_do_not_vanish_on_flat_skin_are_refused(term):
    with pytest.raises(ValueError, match="allowed are functions 0 to 5"):
        hyperbola_form(CYLINDER[0], narrow=0.3, wide=0.8, numerator=(term,), below=0)


def test_the_widths_are_in_order():
    with pytest.raises(ValueError, match="allowed is narrow < wide"):
        hyperbola_form(CYLINDER[0], narrow=0.8, wide=0.3, numerator=TERMS, below=0)


def test_the_forms_are_quotients_with_twenty_coefficients():
    """So the exchange finds the least largest error that the terms allow."""
    for reference in SKIN_REFERENCES:
        for form in candidates(reference):
            assert form.size == 20
            assert linear_parts(form, scattered(4)) is not None


@pytest.mark.parametrize("surface", ["cylinder", "sphere"])
@pytest.mark.parametrize("channel", ["red", "green", "blue"])
def test_the_best_tables_reach_their_errors(surface, channel):
    name = f"best/skin-{surface}-{channel}-63"
    assert name in names_of_best()
    table = resolve(name).require_table()
    assert table.errors.off_grid.max < GOALS[channel]
    assert table.certificates.denominator_bound > 0.1
    # What the form gives before it is clamped, and how far it may fall as the light turns away
    fitted = resolve(name).require_fitted()
    c, k = np.linspace(-1, 1, 401), np.linspace(0, 0.5, 26)
    at = np.stack(np.meshgrid(c, k, indexing="ij"), axis=-1).reshape(-1, 2)
    values = np.asarray(form_values(fitted, at)).reshape(401, 26)
    assert values.min() > -GOALS[channel]
    assert values.max() < 1 + GOALS[channel]
    risen = np.maximum.accumulate(values, axis=0) - values
    assert risen.max() < 2 * GOALS[channel]


@pytest.mark.slow
def test_pesces_constants_have_the_errors_that_the_page_states():
    stated = {"red": (0.05, 0.07), "green": (0.03, 0.05), "blue": (0.02, 0.03)}
    for channel, (least, most) in stated.items():
        entry = resolve(f"published/skin-cylinder-{channel}")
        reference = CYLINDER[["red", "green", "blue"].index(channel)]
        c, k = np.linspace(-1, 1, 41), np.geomspace(1 / 16, 0.5, 9)
        at = np.stack(np.meshgrid(c, k), axis=-1).reshape(-1, 2)
        worst = np.abs(form_values(entry.require_fitted(), at) - reference.values(at)).max()
        assert least < worst < most
