"""Exported samplers: their code computes what `shading` computes, in every language."""

import functools

import numpy as np
import pytest

from coefficients.catalogue import resolve
from coefficients.code_options import CodeOptions, require_use, shaped
from coefficients.exported_code import source_file, trial_of
from programs import check, evaluate, toolchain, trace, write_source
from programs.toolchains import verification
from quantities.microfacet.samplers import LEAST_ALPHA, SAMPLERS
from tests.shading.microfacets import SAMPLERS as DRAWN
from tests.shading.microfacets import areas, distribution, view_of

NAMES = [f"sampler/{name}" for name in SAMPLERS]
PAIRS = {
    "ggx-upper": "upper",
    "ggx-bounded-cap": "bounded cap",
    "ggx-cap": "cap",
    "ggx-disk": "disk",
}


def some_slow(names, fast: int) -> list:
    """Return names of which all but the first few are for `make test-slow`."""
    return [
        name if k < fast else pytest.param(name, marks=pytest.mark.slow)
        for k, name in enumerate(names)
    ]


@functools.cache
def small_trial(name: str):
    return trial_of(resolve(name), "float", 10)


def evaluated(name: str, rows: np.ndarray, precision: str = "double") -> np.ndarray:
    """Evaluate the exported function of a sampler, with every operation rounded."""
    dtype = {"double": np.float64, "float": np.float32, "half": np.float16}[precision]
    (function,) = resolve(name).functions(precision)
    return evaluate(trace(function), rows, dtype).astype(np.float64)


def rows_at(view, alphas, numbers) -> np.ndarray:
    return np.column_stack([np.tile([*view, *alphas], (len(numbers), 1)), numbers])


@pytest.mark.parametrize("name", some_slow(PAIRS, 2))
def test_code_draws_the_lights_of_the_model_and_weighs_them(name):
    view, alphas = view_of(60, 40), np.array([0.3, 0.8])
    draw, field, count = DRAWN[PAIRS[name]]
    numbers = np.random.default_rng(1).random((200, count))
    found = evaluated(f"sampler/{name}", rows_at(view, alphas, numbers))
    lights = np.asarray(draw(view, alphas, numbers))
    np.testing.assert_allclose(found[:, :3], lights, atol=1e-13)
    # The weight is f (i·n)/density, with the density of the other function.
    density = evaluated(f"sampler/{name}-pdf", rows_at(view, alphas, lights))[:, 0]
    area = float(getattr(areas(view, alphas), field))
    above = lights[:, 2] > 0
    assert np.all(above == (found[:, 3] > 0)) and np.all(above == (density > 0))
    normals = distribution(lights + view, alphas)
    np.testing.assert_allclose(density, above * normals / (4 * area), rtol=1e-12)
    sigma_i, sigma_o = (np.linalg.norm(w * [*alphas, 1.0], axis=-1) for w in (lights, view))
    brdf = normals / (2 * (view[2] * sigma_i + lights[:, 2] * sigma_o))
    expected = (brdf * lights[:, 2])[above] / density[above]
    np.testing.assert_allclose(found[above, 3], expected, rtol=1e-12)


@pytest.mark.parametrize("name", some_slow(NAMES, 1))
def test_code_in_c_passes_and_little_is_allowed(name):
    if toolchain("c").missing("float"):
        pytest.skip("gcc is missing")
    trial = small_trial(name)
    result = check(trial, "c")
    assert result.status == "passed", result.reason
    assert result.points == len(trial.points)
    assert result.form.not_finite == 0
    # What is allowed is not so much that a wrong choice of the mirror image would pass.
    largest = np.abs(trial.form).max()
    assert result.allowed.largest < 1e-3 * largest
    assert result.units.rms < 100


def test_code_with_another_choice_fails(monkeypatch):
    def wrong(functions, *given, **options):
        source = write_source(functions, *given, **options)
        assert "(2.0f * " in source
        return source.replace("(2.0f * ", "(1.9f * ")

    monkeypatch.setattr(verification, "write_source", wrong)
    assert check(small_trial("sampler/ggx-upper"), "c").status == "failed"


@pytest.mark.parametrize("precision", ["float", "half"])
@pytest.mark.parametrize("name", some_slow(PAIRS, 1))
def test_values_are_finite_for_hostile_numbers(name, precision):
    """Views on the axes and at grazing, α of all sizes and below zero, numbers at and beyond 1."""
    views = [view_of(0, 0), view_of(90, 0), view_of(90, 90), view_of(89.99, 45), view_of(30, 200)]
    alphas = [-1.0, 0.0, LEAST_ALPHA, 0.3, 1.0, 1e4]
    numbers = [0.0, 1e-7, 0.25, 0.5, 0.75, 1.0, 2.0]
    count = DRAWN[PAIRS[name]][2]
    rows = [
        [*view, alpha_x, alpha_y, *(each for each, _ in zip(random, range(count), strict=False))]
        for view in views
        for alpha_x in alphas
        for alpha_y in alphas
        for random in [(a, b, c) for a in numbers for b in numbers for c in (0.0, 0.5, 1.0)]
    ]
    found = evaluated(f"sampler/{name}", np.array(rows), precision)
    assert np.isfinite(found).all()
    if name == "ggx-upper":
        assert found[:, 2].min() >= (0.0 if precision == "half" else 1e-12)


def test_a_structure_has_the_layout_that_is_asked_for():
    entry = resolve("sampler/ggx-upper")
    source = write_source(entry.functions(), "hlsl")
    assert "struct GgxSample {\n    float w[4];\n};" in source
    options = CodeOptions(layout="vec4")
    require_use(options, [entry.problem])
    source = write_source(shaped(entry, options).functions(), "hlsl")
    assert "struct GgxSample {\n    float4 w0;\n};" in source
    with pytest.raises(ValueError, match="layout 'vec4' is for structures"):
        require_use(options, [entry.problem, resolve("exact/q").problem])


def test_what_a_sampler_cannot_do_is_refused():
    entry = resolve("sampler/ggx-upper")
    with pytest.raises(ValueError, match="has no coefficients"):
        entry.require_table()
    bundled = CodeOptions(interface="material", bundle="unity")
    with pytest.raises(ValueError, match="functions of one value: sampler/ggx-upper has 4"):
        source_file(entry, "hlsl", options=bundled)


def test_every_sampler_has_its_density():
    assert set(SAMPLERS) == {*PAIRS, *(f"{name}-pdf" for name in PAIRS)}
