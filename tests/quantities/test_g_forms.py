"""Forms of G: the limits that are built in."""

import jax
import numpy as np
import pytest

from quantities.fuzz.g_forms import decay_g, tied_g


def some(form):
    """Return the form with coefficients near a start, none of which is zero."""
    return form.fitted(form.starts[0] + 0.02 * np.cos(np.arange(form.size)))


def test_grazing_views_see_everything():
    assert float(some(tied_g(poles=1, root=1))(0.3, 1e-6)) == pytest.approx(1, abs=1e-5)
    form = decay_g(decay="power", rate="pole", factor="inverse")
    assert float(some(form)(0.3, 1e-7)) == pytest.approx(1, abs=1e-5)


@pytest.mark.parametrize("nu", [0.1, 0.5, 1.0])
def test_the_slope_at_zero_density_is_one_over_the_cosine(nu):
    fitted = some(tied_g(poles=1, root=1))
    assert float(jax.grad(lambda d: fitted(d, nu))(1e-14)) == pytest.approx(1 / nu, rel=1e-4)
