"""Filters of maps: lobes as arrays, chains, flat normals, steep ones, and errors on footprints."""

import numpy as np
import pytest

from coefficients.catalogue import resolve
from shadefit.cli import main
from shadefit.maps.best_lobe import best_lobe, slopes_of_lobes, unit_slopes
from shadefit.maps.errors import filter_errors
from shadefit.maps.filters import FILTERS, LobeMap, filter_chain, lobe_map
from shadefit.maps.lobes import (
    limited,
    lobe_matrices,
    lobes_of_matrices,
    matrices_of_slopes,
    slope_moments,
)
from shadefit.maps.moments import widened
from shadefit.maps.synthetic import MAPS, synthetic_map
from shadefit.maps.tables import WIDENING, widening
from shading.maps.encode import entries_of_widths
from shading.maps.extraction import lobe_of_matrix
from shading.maps.lobe import lobe_matrix

FLAT = np.array([0.04, 0.01, 0.09])


def flat_map(height: int, width: int) -> LobeMap:
    normals = np.zeros((height, width, 3))
    normals[..., 2] = 1
    return lobe_map(normals, np.broadcast_to(FLAT, normals.shape))


@pytest.mark.parametrize("name", list(MAPS))
def test_lobes_come_back_from_their_matrices(name):
    base = synthetic_map(name, 32, 3)
    normals, roughness = lobes_of_matrices(lobe_matrices(base.normals, base.roughness))
    assert np.max(np.abs(normals - base.normals)) < 1e-12
    assert np.max(np.abs(roughness - base.roughness)) < 1e-12


def test_arrays_of_lobes_are_those_of_one_texel():
    base = synthetic_map("weave", 16, 3)
    normal, roughness = base.normals[3, 5], base.roughness[3, 5]
    one = np.asarray(lobe_matrix(normal, roughness))
    many = lobe_matrices(normal, roughness)
    assert np.allclose(many, one[np.triu_indices(3)], rtol=0, atol=1e-15)
    again = lobe_of_matrix(one)
    found = lobes_of_matrices(many[None])
    assert np.allclose(found[0][0], again[0], atol=1e-13)
    assert np.allclose(found[1][0], again[1], atol=1e-13)


def test_a_groove_that_is_too_steep_keeps_the_normal_and_a_width_of_one():
    sides = np.array([[-1.0, 0, 0.9], [1.0, 0, 0.9]])
    sides /= np.linalg.norm(sides, axis=-1, keepdims=True)
    matrices = lobe_matrices(sides, np.broadcast_to([0.01, 0, 0.01], (2, 3)))
    normals, roughness = lobes_of_matrices(np.mean(matrices, axis=0)[None])
    assert np.allclose(normals, [[0, 0, 1]], atol=1e-14)
    assert roughness[0, 0] == pytest.approx(1)


def test_widths_are_limited_and_axes_stay():
    wide = entries_of_widths(1.5, 0.5, 0.7)
    assert np.allclose(limited(wide[None])[0], entries_of_widths(1.0, 0.5, 0.7), atol=1e-14)


@pytest.mark.parametrize("method", FILTERS)
def test_flat_normals_of_one_roughness_stay_as_they_are(method):
    levels = filter_chain(flat_map(16, 8), method)
    assert [each.size for each in levels] == [(16, 8), (8, 4), (4, 2), (2, 1), (1, 1)]
    for each in levels:
        assert np.max(np.abs(each.roughness - FLAT)) < 1e-14
        assert np.max(np.abs(each.normals - [0, 0, 1])) < 1e-14


def test_with_flat_normals_lean_and_sggx_are_equal():
    base = synthetic_map("spun", 32, 1)
    lean, sggx = filter_chain(base, "lean"), filter_chain(base, "sggx")
    for one, other in zip(lean, sggx, strict=True):
        assert np.max(np.abs(one.roughness - other.roughness)) < 1e-14


def test_sggx_filtering_adds_the_covariance_of_slopes_once_and_lean_twice():
    x = 0.2
    normals = np.array([[[-x, 0, 1.0], [x, 0, 1.0]]]) / np.hypot(1, x)
    base = lobe_map(normals, np.full((1, 2, 3), [1e-8, 0, 1e-8]))
    for method, times in (("sggx", 1), ("lean", 2)):
        last = filter_chain(base, method)[-1]
        assert last.roughness[0, 0, 0] == pytest.approx(times * x * x, rel=1e-6), method


@pytest.mark.parametrize("method", FILTERS)
def test_blocks_change_nothing(method):
    base = synthetic_map("strong-bumps", 64, 2)
    whole, cut = (filter_chain(base, method, block=block) for block in (1 << 18, 1024))
    for one, other in zip(whole, cut, strict=True):
        assert np.array_equal(one.normals, other.normals)
        assert np.array_equal(one.roughness, other.roughness)


def test_progress_ends_at_all_texels():
    told = []
    filter_chain(flat_map(32, 32), "kl", progress=lambda done, total: told.append((done, total)))
    assert told[-1][0] == told[-1][1]
    assert [done for done, _ in told] == sorted(done for done, _ in told)


def test_the_widening_is_that_of_its_table():
    fitted = resolve(WIDENING).require_fitted()
    u = np.array([0.3, 0.9])
    expected = [fitted(a, b) for a, b in zip(u, u[::-1], strict=True)]
    assert np.allclose(widening(u, u[::-1]), expected, rtol=1e-14)


def test_a_spread_lobe_is_widened_along_its_axes():
    spread, covariance = (
        entries_of_widths(0.3, 0.1, 0.4),
        0.02 * entries_of_widths(1.0, 1.0, 0.0),
    )
    found = widened(spread[None], covariance[None])[0]
    t = np.array([0.02 / 0.09, 0.02 / 0.01])
    u = t / (1 + t)
    ratios = (1 + t) * widening(u, u[::-1])
    expected = entries_of_widths(0.3 * ratios[0] ** 0.5, 0.1 * ratios[1] ** 0.5, 0.4)
    assert np.allclose(found, expected, rtol=1e-12)


def test_the_best_lobe_of_equal_lobes_is_that_lobe():
    mean, spread = np.array([0.1, -0.2]), np.array([0.04, 0.01, 0.09])
    unit = unit_slopes(4, 2, 3)
    slopes = slopes_of_lobes(np.tile(mean, (4, 1)), np.tile(spread, (4, 1)), unit)
    found = best_lobe(slopes, np.ones(len(slopes)), mean + 0.05, 2 * spread, steps=200)
    assert np.allclose(found[0], mean, atol=1e-13)
    assert np.allclose(found[1], spread, atol=1e-13)


def test_moments_of_slopes_and_back():
    base = synthetic_map("strong-bumps", 16, 2)
    matrices = lobe_matrices(base.normals, base.roughness)
    again = matrices_of_slopes(*slope_moments(matrices))
    assert np.allclose(again, matrices / matrices[..., 5:], rtol=0, atol=1e-15)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"normals": np.zeros((4, 4))}, "allowed is (height, width, 3)"),
        ({"normals": np.full((4, 4, 3), np.nan)}, "finite"),
        ({"normals": np.full((4, 4, 3), 0.5)}, "unit normals"),
        ({"normals": np.broadcast_to([0.0, 0, -1], (4, 4, 3))}, "z > 0"),
        ({"roughness": np.full((4, 2, 3), 0.1)}, "(4, 4, 3)"),
        ({"roughness": np.full((4, 4, 3), 0.1)}, "not positive"),
        ({"roughness": np.broadcast_to([2.0, 0, 0.1], (4, 4, 3))}, "width 1.414"),
    ],
)
def test_hostile_maps_are_refused_in_one_line(changed, message):
    base = flat_map(4, 4)
    given = {"normals": base.normals, "roughness": base.roughness} | changed
    with pytest.raises(ValueError) as caught:
        lobe_map(**given)
    assert message in str(caught.value) and str(caught.value).isprintable()


def test_other_arguments_are_refused():
    base = flat_map(4, 4)
    with pytest.raises(ValueError, match="height = 3: allowed are powers of two"):
        lobe_map(base.normals[:3], base.roughness[:3])
    with pytest.raises(ValueError, match="filter 'mean' is not known: allowed are naive"):
        filter_chain(base, "mean")
    with pytest.raises(ValueError, match="block = 4: allowed are 1024"):
        filter_chain(base, "kl", block=4)
    with pytest.raises(ValueError, match="footprints = 99: allowed are 1 to 16"):
        filter_errors(["spun"], footprints=99)
    with pytest.raises(ValueError, match="map 'wool' is not known"):
        synthetic_map("wool", 32, 1)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ([], "--convention"),
        (["--convention", "opengl", "--method", "mean"], "'mean' is not one of"),
        (["--convention", "opengl", "--colour-space", "srgb"], "are linear, not srgb"),
        (["--convention", "opengl", "--colour-space", "linear"], "No such file"),
    ],
)
def test_the_command_refuses_bad_input_in_one_line(tmp_path, monkeypatch, capsys, change, message):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit) as status:
        main(["maps", "filter", "n.png", "r.png", *change])
    assert status.value.code == 2
    error = capsys.readouterr().err
    assert message in error and error.count("\n") == 1
    assert not list(tmp_path.rglob("*.png"))


@pytest.fixture(scope="module")
def measured():
    found = filter_errors(footprints=8)
    return {(each.map, each.method): each for each in found}


@pytest.mark.slow
def test_the_best_filter_reaches_the_best_single_lobe(measured):
    def mean(method, field):
        return np.mean([getattr(measured[name, method], field) for name in MAPS])

    assert mean("kl", "total_variation") <= 1.02 * mean("best", "total_variation")
    assert mean("kl", "radiance") <= 0.85 * mean("sggx", "radiance")


@pytest.mark.slow
def test_where_the_talk_is_right_about_lean_and_where_not(measured):
    # Widths as large as the normals' slopes, few steep texels: SGGX filtering is nearer.
    for name in ("scratches", "foil"):
        assert measured[name, "sggx"].total_variation < measured[name, "lean"].total_variation
    assert measured["scratches", "sggx"].radiance < measured["scratches", "lean"].radiance
    # A little spread of normals adds twice its variance: LEAN is nearer by half in radiance.
    weak = measured["weak-bumps", "sggx"], measured["weak-bumps", "lean"]
    assert weak[0].radiance > 1.5 * weak[1].radiance
    assert weak[0].total_variation > weak[1].total_variation
