"""The ambient model: its errors where they are known, and its largest radiances."""

import functools
import json

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from coefficients.catalogue import resolve
from integrals import PS
from integrals.fuzz.radiance import base_response, layer_response
from shadefit.ambient.energy import deferred_in_uniform_light, largest_radiances
from shadefit.ambient.errors import model_errors
from shadefit.ambient.lights import lights
from shadefit.ambient.radiances import (
    HEMISPHERE_RULE,
    materials_and_views,
    phase_integrals,
    radiances,
)
from shadefit.ambient.sheet import interpolate_period
from shadefit.cli import main
from shadefit.outputs import AmbientOutput
from shadefit.render.functions import EXACT, table_sets
from shading import (
    AMBIENT_MODELS,
    deferred_radiance,
    direction,
    fiber_direction,
    fiber_projected_area,
    fiber_root,
    radiance,
    sample_phase_function,
)
from tests.batches import batched

# The largest error of HEMISPHERE_RULE for radiances in light whose mean radiance is about 1.
ACCURACY = 1e-4


@functools.cache
def radiances_at_six_points():
    """Return radiances for an isotropic material, then for a sharp one, three views each."""
    views = [(0.0, 0.0), (1.0, np.pi / 4), (1.4, np.pi)]
    materials = [(1.0, 0.4, 0.2), (0.3, 0.4, 0.2)]
    at = np.array([[*m, *v] for m in materials for v in views])
    return radiances(at, (EXACT, published()))


def published():
    (found,) = (each for each in table_sets() if each.name == "published")
    return found


def test_the_harmonics_of_lights_have_the_lobes_as_radiance():
    ways = np.random.default_rng(0).normal(size=(200, 3))
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    axes = {"from above": 2, "where fibres point": 0, "from the side": 1}
    every = lights()
    for name, axis in axes.items():
        values = jax.vmap(radiance, (None, 0))(every[name], ways)
        np.testing.assert_allclose(values, ((1 + ways[:, axis]) / 2) ** 2, atol=1e-13)
    uniform = jax.vmap(radiance, (None, 0))(every["uniform"], ways)
    np.testing.assert_allclose(uniform, 1, rtol=1e-13)


@pytest.mark.slow
def test_the_model_is_exact_for_isotropic_fibres_in_uniform_light():
    found = radiances_at_six_points()
    column = found.lights.index("uniform")
    for part in ("layer", "base"):
        model, exact = found.models["exact"][part], found.exact[part]
        np.testing.assert_allclose(model[:3, column], exact[:3, column], atol=ACCURACY)


@pytest.mark.slow
def test_the_models_factor_differs_from_the_phase_integral():
    at = np.array([(1.0, 0.4, 0.2, 1.0, 0.5), (0.3, 0.0, 0.2, 0.0, 0.0), (0.3, 1.0, 0.2, 1.0, 0.5)])
    found = phase_integrals(at)
    np.testing.assert_allclose(found[0], 0.5, atol=ACCURACY)
    # An independent estimate by Monte Carlo, from p(u, v) = p(v, u) σ(v)/σ(u).
    alpha, fiber, view = 0.3, fiber_direction(1.0), direction(1.0, 0.5)
    root, points = fiber_root(fiber, alpha), np.random.default_rng(0).random((200_000, 2))

    def ratio(point):
        light = sample_phase_function(root, view, point)
        areas = [fiber_projected_area(w @ fiber, alpha) for w in (view, light)]
        return jnp.where(light[2] > 0, areas[0] / areas[1], 0.0)

    values = jax.jit(jax.vmap(ratio))(points)
    assert abs(values.mean() - found[2]) < 5 * values.std() / np.sqrt(len(values)) + ACCURACY
    assert abs(found[2] - (1 - PS.value(alpha, 1.0, 1.0, 0.5))) > 0.01


@pytest.mark.slow
def test_for_sharp_fibres_the_model_has_larger_errors_than_its_tables():
    rows = {(row["part"], row["light"]): row for row in model_errors(radiances_at_six_points())}
    row = rows["layer", "against fibres"]
    assert row["rms"]["exact"] > 0.1
    assert abs(row["rms"]["published"] - row["rms"]["exact"]) < 0.3 * row["rms"]["exact"]
    assert rows["base", "uniform"]["rms"]["exact"] < 0.02


@pytest.mark.slow
def test_errors_follow_from_the_radiances():
    found = radiances_at_six_points()
    (row,) = (r for r in model_errors(found) if r["part"] == "layer" and r["light"] == "uniform")
    exact, model = (p["layer"][:, 0] for p in (found.exact, found.models["published"]))
    expected = np.sqrt(np.mean((model - exact) ** 2)) / exact.mean()
    np.testing.assert_allclose(row["rms"]["published"], expected, rtol=1e-12)
    assert set(row["where"]) == {"spread", "tilt", "density", "cos_v", "azimuth"}


@pytest.mark.slow
def test_in_uniform_light_only_tables_at_their_edge_exceed_the_light():
    rows = largest_radiances(radiances_at_six_points())
    largest = {row["what"]: row["largest"] for row in rows}
    # The deferred version has fibres of five times this albedo: three times white.
    assert largest.pop("deferred, albedo 0.6") > 1
    assert all(value < 1 for value in largest.values())
    # The form of the published P_s is as low as −0.0996: without the clamp of its code, the
    # model's layer would exceed the light at grazing views.
    tables = published()
    alpha, theta_f, density, cos_v, phi = 0.15, 0.4073, 0.5, 0.001, np.pi
    sine = np.sqrt(1 - cos_v**2)
    cos_vt = sine * np.cos(phi) * np.sin(theta_f) + cos_v * np.cos(theta_f)
    cosines = (jnp.asarray(x) for x in (cos_v, cos_vt, np.cos(theta_f)))
    assert tables.ps(*cosines, alpha, theta_f) == 0
    form = resolve("published/ps").require_fitted()
    down = float(form(alpha, theta_f, np.arccos(cos_v), phi))
    assert down == pytest.approx(-0.0983, abs=5e-4)
    layer = float(tables.g(density, cos_v))
    assert layer == pytest.approx(0.998, abs=5e-4)
    assert layer * (1 - down) == pytest.approx(1.096, abs=5e-4)


@pytest.mark.slow
def test_tables_of_g_make_the_model_exceed_the_light_for_thin_layers_at_grazing_views():
    at = np.array([(0.15, 0.31, 0.001, np.arccos(0.004), np.pi)])
    found = radiances(at, (EXACT, *table_sets()))
    column = found.lights.index("uniform")
    largest = {
        name: float(parts["layer"][0, column] + parts["base"][0, column])
        for name, parts in found.models.items()
    }
    # docs/brdf.md states these.
    assert largest["published"] == pytest.approx(1.039, abs=1e-3)
    assert largest["refitted"] == pytest.approx(1.042, abs=1e-3)
    assert largest["exact"] < 1 and largest["best"] < 1


@pytest.mark.slow
def test_the_deferred_version_is_linear_in_albedo_and_can_exceed_the_light():
    low, high = deferred_in_uniform_light(0.1, 0.1), deferred_in_uniform_light(0.6, 0.1)
    np.testing.assert_allclose(high, 6 * low, rtol=1e-12)
    assert high > 1
    # The same integral with uniform random directions of light.
    rng = np.random.default_rng(1)
    cosine, phi = rng.uniform(-0.2, 1, 100_000), rng.uniform(0, 2 * np.pi, 100_000)
    sine = np.sqrt(1 - cosine**2)
    ways = np.stack([sine * np.cos(phi), sine * np.sin(phi), cosine], axis=1)
    view = direction(np.arccos(0.1), 0.0)
    seen = jax.jit(jax.vmap(lambda u: deferred_radiance(u, view, 0.1, 1.0)))(ways)
    mean, error = seen.mean(), seen.std() / np.sqrt(len(seen))
    assert abs(2 * np.pi * 1.2 * mean - low) < 5 * 2 * np.pi * 1.2 * error


@pytest.mark.slow
def test_the_hemisphere_rule_has_the_stated_accuracy():
    at = materials_and_views()[::7]
    coarse = batched(functools.partial(layer_response, **HEMISPHERE_RULE), 16)(*at.T)
    fine = batched(functools.partial(layer_response, step=1 / 16, azimuths=256), 16)(*at.T)
    assert np.abs(coarse - fine).max() < ACCURACY
    bases = [
        batched(functools.partial(base_response, **rule), 16)(*at[::5, :3].T)
        for rule in (HEMISPHERE_RULE, {"step": 1 / 16, "azimuths": 256})
    ]
    for coarse, fine in zip(*bases, strict=True):
        assert np.abs(coarse - fine).max() < ACCURACY


@pytest.mark.slow
def test_the_command_prints_what_it_measured(tmp_path, capsys):
    with pytest.raises(SystemExit) as stopped:
        main(["ambient", "--out", str(tmp_path), "--json"])
    assert stopped.value.code == 0
    record = json.loads(capsys.readouterr().out)
    AmbientOutput.model_validate(record)
    assert record["points"] == len(materials_and_views())
    assert len(record["errors"]) == 2 * len(lights())
    assert len(record["models"]) > len(AMBIENT_MODELS)
    assert (tmp_path / "ambient.png").stat().st_size > 10_000


@pytest.mark.parametrize("n", [7, 8])
def test_a_sum_of_harmonics_is_interpolated_exactly(n):
    def wave(x):
        return np.stack([1 + np.cos(x) - 2 * np.sin(3 * x), np.cos(2 * x)])

    found = interpolate_period(wave(2 * np.pi * np.arange(n) / n), 50)
    np.testing.assert_allclose(found, wave(np.linspace(0, 2 * np.pi, 51)), atol=1e-14)
