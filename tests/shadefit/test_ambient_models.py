"""Models of the layer at the points that judge them, and the cloth that is drawn by them."""

from dataclasses import replace

import numpy as np
import pytest

from coefficients.catalogue import resolve
from integrals.fuzz.radiance import layer_response
from shadefit.ambient import cloth
from shadefit.ambient.lights import lights
from shadefit.ambient.models import CHOICES, EXACT, EXPORTED, model_rows, model_weights, views
from shadefit.ambient.radiances import materials_and_views, radiances
from shadefit.render.functions import EXACT as EXACT_FUNCTIONS
from shadefit.render.functions import exported_functions
from shading import AMBIENT_MODELS, harmonics
from shading.harmonics import LOBE

SOME = materials_and_views()[::97]


@pytest.mark.slow
def test_the_talks_weights_are_those_of_its_mean_radiance():
    view = views(SOME)
    weights = model_weights("talk", view, SOME)
    level = view.scattering * (1 - view.scattered)
    expected = np.zeros_like(weights)
    # Half of the cosine of order one, about the normal
    expected[:, 0], expected[:, 2] = np.sqrt(1 / (4 * np.pi)), np.sqrt(3 / (4 * np.pi)) / 2
    np.testing.assert_allclose(weights, level[:, None] * expected, atol=1e-14)


@pytest.mark.slow
def test_errors_of_the_models():
    found = radiances(materials_and_views(), (EXACT_FUNCTIONS,))
    rows = {(r["model"], r["scattered"], r["scattering"]): r for r in model_rows(found)}
    # The talk's model is measured in two ways.
    talk, layer = rows["talk", EXACT, EXACT], found.models["exact"]["layer"] - found.exact["layer"]
    expected = np.sqrt(np.mean(layer**2, axis=0)) / found.exact["layer"].mean(axis=0)
    np.testing.assert_allclose(list(talk["rms"].values()), expected, rtol=1e-9)
    uniform = {key: row["rms"]["uniform"] for key, row in rows.items()}
    assert uniform["cheap", *EXPORTED] < 0.05
    assert uniform["talk", *EXPORTED] > 0.18
    recommended = rows["recommended", *EXPORTED]
    assert all(value < 0.082 for value in recommended["rms"].values())
    assert recommended["least"] >= 0
    # No layer is brighter than the light, and the best tables are not worse than exact functions.
    assert all(row["brightest"] < 1 for row in rows.values())
    for name in AMBIENT_MODELS:
        one, other = (max(rows[name, *pair]["rms"].values()) for pair in CHOICES[:2])
        assert abs(one - other) < 0.01
        assert set(rows[name, *EXPORTED]["operations"]) == {"moments", "weights", "light", "base"}
    # With a better model than the talk's, tables matter.
    assert uniform["cheap", "published/ps", "published/g"] > 1.5 * uniform["cheap", *EXPORTED]
    assert (
        uniform["recommended", "closed form", "best/g-9"] > 1.5 * uniform["recommended", *EXPORTED]
    )


@pytest.mark.slow
def test_views_with_tables_have_the_values_of_these():
    names = ("best/ps-25", "best/g-9")
    other = exported_functions("x", *map(resolve, (*names, "best/q-5", "best/r-25")))
    view = views(SOME, *names)
    alpha, theta_f, density, theta_v, _ = SOME[3]
    expected = other.g(density, np.cos(theta_v))
    assert abs(view.scattering[3] - expected) < 1e-14
    expected = other.ps(view.cos_vn[3], view.cos_vt[3], view.cos_nt[3], alpha, theta_f)
    assert abs(view.scattered[3] - expected) < 1e-14


def test_lights_are_lobes_of_the_stated_harmonics():
    axis = np.array([0.6, 0.0, 0.8])
    values = [LOBE @ (np.asarray(harmonics(axis)) * np.asarray(harmonics(w))) for w in np.eye(3)]
    np.testing.assert_allclose(values, ((1 + axis) / 2) ** 2, atol=1e-14)
    assert set(lights()) >= {"uniform", "from the side"}


@pytest.mark.slow
def test_the_cloth_is_exact_where_it_says_so():
    """The interpolated weights at random views are those of quadrature."""
    point = np.array([0.32, 0.96, 0.3])
    rng = np.random.default_rng(2)
    angles = np.stack([np.arccos(rng.uniform(0.02, 1, 6)), rng.uniform(-np.pi, np.pi, 6)], axis=1)
    found = cloth._exact_weights(point, angles)
    expected = [np.asarray(layer_response(*point, *each)) for each in angles]
    np.testing.assert_allclose(found, expected, atol=2e-4)


@pytest.mark.slow
def test_the_cloth_is_nearer_to_the_exact_one_by_the_better_model():
    drawn = cloth.render_cloth(replace(cloth.SETTINGS, size=24))
    talk, better = (np.sqrt(np.mean(drawn.differences(n) ** 2)) for n in cloth.MODELS)
    assert better < 0.06
    assert talk > 0.3
    assert drawn.exact.shape == (24, 24, 3)
