"""The exported ambient functions: their values, invariances, limits, hostile arguments and cost."""

import functools

import numpy as np
import pytest

from coefficients.ambient import PARTS, ambient_function, ambient_problems, part_costs, tables
from coefficients.ambient.problems import AXES
from coefficients.catalogue import resolve
from coefficients.code_options import CodeOptions
from coefficients.exported_code import source_file
from fitting.points.grids import sobol_points
from programs import (
    CallSequence,
    Trial,
    check,
    count_operations,
    evaluate,
    toolchain,
    trace,
    write_source,
)
from shading import (
    AMBIENT_MODELS,
    LayerView,
    ambient_attenuation,
    harmonics,
    irradiance,
    layer_radiance,
)

NAMES = tuple(ambient_problems())
# The most precise model has all that the others have, so these are slow tests.
EACH = [pytest.param(name, marks=[] if name == NAMES[-1] else [pytest.mark.slow]) for name in NAMES]
# The places of the arguments in a row
NORMAL, VIEW, FIBER = slice(0, 3), slice(3, 6), slice(6, 9)
ALPHA, DENSITY = 9, 10
LIGHT, FIBER_ALBEDO, BASE_ALBEDO = slice(11, 38), slice(38, 41), slice(41, 44)
UNIFORM = np.sqrt(4 * np.pi)


@functools.cache
def program(name):
    return trace(ambient_function(name))


@functools.cache
def arguments(count=256):
    """Return rows (count, 44) of arguments at Sobol' points of the axes."""
    points = sobol_points(AXES, int(np.log2(count)), 5)
    (rows,) = ambient_problems()["talk"].exact_code.arguments_at(points)
    return rows


# Every model in every language is verified by tests/coefficients/test_functions.py.
def test_code_in_c_passes():
    if toolchain("c").missing("float"):
        pytest.skip("gcc is missing")
    calls = CallSequence((ambient_function(NAMES[-1]),), lambda rows: (rows,))
    result = check(Trial(calls, arguments(), "float"), "c")
    assert result.status == "passed", result.reason
    assert result.form.not_finite == 0


@pytest.mark.parametrize("name", EACH)
def test_values_are_those_of_shading(name):
    """One row, composed of the functions of `shading` and of the tables, step by step."""
    row = arguments()[77]
    n, v, t = row[NORMAL], row[VIEW], row[FIBER]
    alpha, density, light = row[ALPHA], row[DENSITY], row[LIGHT].reshape(9, 3)
    cosines = n @ v, v @ t, n @ t
    scattered = tables.scattered(*cosines, alpha)
    view = LayerView(*cosines, alpha, density, tables.scattering(n @ v, density), scattered)
    layer = layer_radiance(AMBIENT_MODELS[name](view), light, n, v, t) * row[FIBER_ALBEDO]
    passing = tables.average_penetration(density), tables.average_scattered(alpha, n @ t)
    shadow = ambient_attenuation(n @ v, density, row[FIBER_ALBEDO], *passing)
    base = row[BASE_ALBEDO] * shadow * irradiance(light, n) / np.pi
    found = evaluate(program(name), row[None])[0]
    np.testing.assert_allclose(found, np.concatenate([layer, base]), rtol=1e-12)


def _turned(row, matrix):
    """Turn the vectors and the light of a row about the origin; the light by its own values."""
    directions = np.random.default_rng(1).normal(size=(40, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    here = np.stack([np.asarray(harmonics(d)) for d in directions])
    there = np.stack([np.asarray(harmonics(matrix @ d)) for d in directions])
    new = row.copy()
    for part in (NORMAL, VIEW, FIBER):
        new[part] = matrix @ row[part]
    light = row[LIGHT].reshape(9, 3)
    new[LIGHT] = np.linalg.lstsq(there, here @ light, rcond=None)[0].ravel()
    return new


@pytest.mark.parametrize("name", EACH)
def test_nothing_depends_on_the_frame_nor_on_the_sign_of_the_fibre(name):
    row = arguments()[100]
    matrix, _ = np.linalg.qr(np.random.default_rng(9).normal(size=(3, 3)))
    if np.linalg.det(matrix) < 0:
        matrix[0] = -matrix[0]
    opposite = row.copy()
    opposite[FIBER] = -opposite[FIBER]
    found = evaluate(program(name), np.stack([row, _turned(row, matrix), opposite]))
    np.testing.assert_allclose(found[1:], found[[0, 0]], rtol=1e-10)


def _white_in_uniform_light(rows):
    rows = rows.copy()
    rows[:, LIGHT] = 0
    rows[:, LIGHT.start : LIGHT.start + 3] = UNIFORM
    rows[:, FIBER_ALBEDO.start :] = 1.0
    return rows


# Where climbing found the largest sum of layer and base, for v·n ≥ 0.02 and v·n ≥ 0.05: α, d, n·t,
# and what docs/brdf.md says of it
BRIGHTEST = {
    "talk": ((0.46, 0.0, 0.576, 1.0), (0.46, 0.0, 0.576, 1.0)),
    "cheap": ((0.1502, 0.00476, 0.766, 1.003), (0.591, 0.0, 0.226, 1.0)),
    "recommended": ((0.1058, 0.00978, 0.8224, 1.010), (0.104, 0.00182, 0.837, 1.0002)),
    "best": ((0.0802, 0.01195, 0.7887, 1.012), (0.0746, 0.00278, 0.8155, 1.0004)),
}


@pytest.mark.parametrize("name", EACH)
def test_white_cloth_in_uniform_light_is_hardly_brighter_than_the_light(name):
    """The exact radiances of layer and base together are at most one."""
    rows = np.concatenate([arguments(), arguments()[:2]])
    for row, height, (alpha, density, fiber, _) in zip(
        rows[-2:], (0.02, 0.05), BRIGHTEST[name], strict=True
    ):
        row[NORMAL], row[ALPHA], row[DENSITY] = (0, 0, 1), alpha, density
        # The fibre leans away from the view.
        row[VIEW] = -np.sqrt(1 - height**2), 0, height
        row[FIBER] = np.sqrt(1 - fiber**2), 0, fiber
    found = evaluate(program(name), _white_in_uniform_light(rows))
    assert np.all(found >= 0)
    sums = found[:, 0] + found[:, 3]
    assert np.max(sums[:-2]) < 1 + 1e-12
    for total, (_, _, _, stated) in zip(sums[-2:], BRIGHTEST[name], strict=True):
        # The excess is stated in one or two digits, rounded upwards.
        assert 0.6 * (stated - 1) - 1e-12 < total - 1 <= stated - 1 + 1e-12


@pytest.mark.parametrize("name", EACH)
def test_values_are_finite_for_hostile_arguments(name):
    """Views below the horizon, vectors that are zero or too long, and any material and light."""
    rng = np.random.default_rng(3)
    rows = rng.choice([0.0, -0.0, 1e-7, -1.0, 1.0, 0.7, 1.01, -3.0, 1e-40], (4000, 44))
    behind = np.repeat(arguments()[:100], 2, axis=0)
    behind[::2, VIEW] *= -1
    behind[1::2, VIEW] = np.cross(behind[1::2, NORMAL], behind[1::2, FIBER])
    # Vectors that nobody normalised, also near directions where all three are the same
    short = arguments().copy()
    short[::2, FIBER] = short[::2, NORMAL]
    short[::4, VIEW] = short[::4, NORMAL]
    short[:, :9] += rng.uniform(-0.2, 0.2, (len(short), 9))
    found = evaluate(program(name), np.concatenate([rows, behind, short]), np.float32)
    assert np.isfinite(found).all()
    assert np.all(found[len(rows) :] >= 0)
    # The light is at most 1.5 in any direction.
    assert np.max(found[len(rows) :]) < 1.5


@pytest.mark.slow
def test_a_number_that_is_none_in_the_material_is_an_end_of_its_domain():
    if toolchain("c").missing("float"):
        pytest.skip("gcc is missing")
    rows = arguments()[[3, 3]].copy()
    rows[0, ALPHA] = rows[1, DENSITY] = np.nan
    function = ambient_function(NAMES[-1])
    # In C, a comparison with NaN is false. `run` would refuse the rows.
    found = toolchain("c").evaluate(write_source(function, "c"), function, rows, "float")
    assert np.isfinite(found).all()


def test_cost_of_the_parts_is_that_of_the_whole():
    parts = part_costs("cheap")
    assert tuple(parts) == PARTS
    assert sum(parts.values()) == count_operations(program("cheap")).operations
    assert all(count > 0 for count in parts.values())
    assert parts["light"] == 27


def test_other_models_are_refused():
    with pytest.raises(ValueError, match="no model is called 'x': allowed are talk, cheap"):
        ambient_function("x")


def test_options_for_other_code_are_refused():
    entries = [resolve(f"ambient/{name}") for name in ("talk", "cheap")]
    with pytest.raises(ValueError, match="FuzzAmbientTalk has 6 values, not one"):
        source_file(entries, "c", options=CodeOptions(together="Both"))
    with pytest.raises(ValueError, match="layout 'vec4' is for structures"):
        source_file(entries, "hlsl", options=CodeOptions(layout="vec4"))
