"""The factors of light in spherical harmonics: other formulas of them, and their tables."""

import jax
import numpy as np
import pytest

from coefficients.catalogue import resolve
from integrals.skin import harmonic_factors
from integrals.skin.band_references import BANDS, SKIN_BANDS, band_factor
from shading.skin import SKIN
from shading.skin.profiles import GaussianProfile

CURVATURES = np.array([0.0, 1e-9, 0.05, 0.2, 0.5, 1.3, 4.0])


def test_the_factors_are_those_of_the_lobes():
    """Another formula, which divides by the curvature."""
    some = CURVATURES[1:]
    expected = np.asarray(jax.vmap(lambda k: harmonic_factors(SKIN, k))(some))
    for number, reference in enumerate(SKIN_BANDS):
        band, channel = divmod(number, 3)
        found = [float(reference.closed_form(k).value) for k in some]
        np.testing.assert_allclose(found, expected[:, channel, band], atol=8e-13)


def test_a_plane_keeps_all_light_and_a_small_sphere_none():
    wide = GaussianProfile((100.0,), ((1.0,),))
    for band in BANDS:
        assert float(band_factor(SKIN.channel(0), band, 0.0)) == 1.0
        # ρ₁ → z/3 and ρ₂ → z²/15 with z = 1/(σκ)²
        expected = {1: 1e-2 / 3, 2: 1e-4 / 15}[band]
        assert float(band_factor(wide, band, 1.0)) == pytest.approx(expected, abs=3e-8)


@pytest.mark.parametrize("band", BANDS)
def test_the_errors_of_all_tables_of_a_band_are_theorems(band):
    for name in ("red-14", "green-7", "blue-7") if band == 1 else ("red-16", "green-10", "blue-7"):
        table = resolve(f"best/skin-band-{band}-{name}").require_table()
        proven = table.certificates.largest_error
        assert table.errors.off_grid.max <= proven.upper <= 5e-4
        assert table.certificates.range[0] > 0.5
        assert table.certificates.float32_rounding.ieee.upper < 3e-7
