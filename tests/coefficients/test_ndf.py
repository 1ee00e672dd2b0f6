"""The table of an NDF, and its code: read back, refused if hostile, and run."""

import json

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from coefficients.ndf_code import ndf_of, ndf_source, ndf_trials
from coefficients.ndf_table import (
    BLEND_SCHEMA,
    SCHEMA,
    BlendProfile,
    NdfBlendTable,
    NdfErrors,
    NdfTable,
    read_ndf,
    serialise_ndf,
)
from programs import check, evaluate, toolchain, trace
from quantities.piecewise.code import ndf_functions
from quantities.piecewise.knots import equidistributed_knots
from quantities.piecewise.targets import analytic_ndf
from shading import direction
from shading.piecewise.hidden_area import beyond_edge, hidden_primitives
from shading.piecewise.moments import mass_below, normalised
from shading.piecewise.ndf import coefficients, profile
from shading.piecewise.visible_sampling import visible_pdf
from tests.integrals.piecewise_examples import random_blend, random_profile
from tests.shading.test_sampling import REJECTION, p_value

GAPS = normalised(
    profile(np.array([0, 0.3, 0.5, 0.9, 1.2, np.pi / 2]), np.array([0.0, 0, 1, 0, 0, 0]), "cos2")
)


@pytest.fixture(scope="module")
def table():
    target = analytic_ndf("ggx:0.2")
    knots = equidistributed_knots(target.of, 10)
    ndf = normalised(profile(knots, target.of(knots), "cos2"))
    return NdfTable(
        schema=SCHEMA,
        target="ggx:0.2",
        linear_in="cos2",
        monotone=False,
        knots=[float(each) for each in ndf.knots],
        values=[float(each) for each in ndf.values],
        mass=1.01,
        errors=NdfErrors(total_variation=1e-3, masking=1e-4, directions=400),
        command="shadefit ndf ggx:0.2",
    )


@pytest.fixture(scope="module")
def blend_table():
    blend = random_blend(6, 5, "cos2")
    x, y = (
        BlendProfile(
            knots=[float(at) for at in each.knots],
            values=[float(at) for at in each.values],
            mass=1.0,
        )
        for each in (blend.x, blend.y)
    )
    return NdfBlendTable(
        schema=BLEND_SCHEMA,
        target="two",
        linear_in="cos2",
        monotone=False,
        x=x,
        y=y,
        errors=None,
        command="none",
    )


def test_a_blend_is_read_back_bit_by_bit(blend_table, tmp_path):
    path = tmp_path / "blend.json"
    path.write_text(serialise_ndf(blend_table))
    assert read_ndf(path) == blend_table
    bad = json.loads(serialise_ndf(blend_table))
    bad["y"]["values"][0] = -1
    path.write_text(json.dumps(bad))
    with pytest.raises(ValueError, match=r"y: values: expected are numbers ≥ 0"):
        read_ndf(path)


def test_a_table_is_read_back_bit_by_bit(table, tmp_path):
    path = tmp_path / "ndf.json"
    path.write_text(serialise_ndf(table))
    assert read_ndf(path) == table
    assert serialise_ndf(read_ndf(path)) == path.read_text()


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"values": [1.0, 2.0]}, "11 knots and 2 values"),
        ({"knots": [0.0] * 11}, "increasing angles"),
        ({"values": [-1.0] * 11}, "numbers ≥ 0"),
        ({"linear_in": "cos"}, "linear_in"),
        ({"schema": "shadefit.ndf/9"}, "schema"),
        ({"code": "import os"}, "code"),
        ({"mass": 0.0}, "mass"),
    ],
)
def test_bad_tables_are_refused_with_one_line(table, tmp_path, change, said):
    path = tmp_path / "bad.json"
    data = {**json.loads(serialise_ndf(table)), **change}
    path.write_text(json.dumps(data))
    with pytest.raises(ValueError, match=said) as raised:
        read_ndf(path)
    assert "\n" not in str(raised.value)


def test_no_table_is_refused(tmp_path):
    with pytest.raises(ValueError, match="No such file"):
        read_ndf(tmp_path / "none.json")
    (tmp_path / "text.json").write_text("[" * 100_000)
    with pytest.raises(ValueError, match=r"text\.json"):
        read_ndf(tmp_path / "text.json")


@pytest.fixture(scope="module", params=["table", "blend_table"])
def trials(request):
    """Trials of all functions, whose exact values are computed once."""
    return ndf_trials(ndf_of(request.getfixturevalue(request.param)), "float")


@pytest.mark.slow
def test_code_has_the_values_of_the_library(trials):
    """In float64 only the arctangent's polynomial and the rounding of float32 inputs differ."""
    limits = {"NdfD": 3e-5, "NdfHidden": 6e-7, "NdfVisibility": 3e-6, "NdfSquaredSine": 1e-7}
    # A visible normal at the end of the arc of azimuths is a double root.
    limits |= {"NdfNormal": 1e-4, "NdfVisibleNormal": 2e-3}
    for trial in trials:
        (function,) = trial.calls.functions
        gap = np.abs(trial.form - trial.integral)
        assert gap.max() < limits[function.name], function.name
        assert np.sqrt(np.mean(gap**2)) < 2e-5, function.name


@pytest.mark.slow
def test_code_is_run(trials):
    if toolchain("c").missing("float") is not None:
        pytest.skip("no C compiler is installed")
    checks = {trial.calls.functions[0].name: check(trial, "c").status for trial in trials}
    assert list(checks.values()) == ["passed"] * 5
    assert "NdfVisibleNormal" in checks


@pytest.mark.slow
def test_a_profile_with_gaps_has_code_too():
    for trial in ndf_trials(GAPS, "float")[:4]:
        assert np.abs(trial.emulated(np.float32) - trial.integral).max() < 2e-5


VIEWS = {"high": (0.4, 0.7), "grazing": (1.5, 0.7)}


def drawn_by_code(ndf, view: tuple[float, float], count: int, dtype=np.float32) -> np.ndarray:
    """Return visible normals of the program that is exported, every operation rounded."""
    program = trace(ndf_functions(ndf)[-1])
    samples = np.random.default_rng(9).random((count, 2))
    rows = np.concatenate([np.tile(np.asarray(direction(*view)), (count, 1)), samples], axis=1)
    return np.asarray(evaluate(program, rows.astype(dtype).astype(float), dtype), float).reshape(
        -1, 3
    )


@pytest.mark.parametrize(
    ("name", "view"),
    [
        ("profile", "grazing"),
        pytest.param("profile", "high", marks=pytest.mark.slow),
        pytest.param("blend", "grazing", marks=pytest.mark.slow),
        pytest.param("blend", "high", marks=pytest.mark.slow),
        pytest.param("gaps", "grazing", marks=pytest.mark.slow),
    ],
)
def test_the_code_draws_visible_normals_of_their_density(name, view):
    """Neither the profile nor the blend is monotone; chi-square of float32 samples."""
    ndf = {
        "profile": random_profile(3, 6, "cos2"),
        "blend": random_blend(6, 5, "cos2"),
        "gaps": GAPS,
    }[name]
    normals = drawn_by_code(ndf, VIEWS[view], 20_000)
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1, atol=1e-6)
    outgoing = direction(*VIEWS[view])

    pdf = jax.jit(jax.vmap(lambda m: visible_pdf(ndf, outgoing, m)))

    def density(at):
        values = pdf(np.where(at[:, 2:] > 0, at, [0.0, 0.0, 1.0]))
        return np.where(at[:, 2] > 0, values, 0.0)

    assert p_value(normals, density) > REJECTION
    if name == "profile" and view == "grazing":
        # The test has the power to see the wrong direction of the view.
        assert p_value(drawn_by_code(ndf, (1.3, 0.7), 20_000), density) < 1e-6


@pytest.mark.slow
@pytest.mark.parametrize("theta_o", [0.9, 1.55])
@pytest.mark.parametrize("source", ["random", "ggx:0.1"])
def test_the_polar_angle_of_the_code_inverts_the_visible_area(source, theta_o):
    """The part of the visible area below what is drawn is u1, after 7 steps."""
    if source == "random":
        ndf = random_profile(3, 6, "cos2")
    else:
        target = analytic_ndf(source)
        knots = equidistributed_knots(target.of, 16)
        ndf = normalised(profile(knots, target.of(knots), "cos2"))
    first = np.concatenate([np.linspace(0, 1, 200, endpoint=False), 1 - np.geomspace(1e-7, 1, 100)])
    view = np.asarray(direction(theta_o, 0.0))
    rows = np.concatenate(
        [np.tile(view, (len(first), 1)), first[:, None], np.full((len(first), 1), 0.3)], axis=1
    )
    drawn = np.asarray(evaluate(trace(ndf_functions(ndf)[-1]), rows, np.float64)).reshape(-1, 3)
    theta = np.arctan2(np.hypot(drawn[:, 0], drawn[:, 1]), drawn[:, 2])

    def area(angle):
        u, rim = beyond_edge(jnp.minimum(ndf.knots, angle), theta_o)
        a, b = coefficients(ndf)
        for_a, for_b = hidden_primitives(u, rim, theta_o)
        hidden = jnp.sum(a * jnp.diff(for_a) + b * jnp.diff(for_b))
        return jnp.cos(theta_o) * mass_below(ndf, angle) + hidden

    found = jax.vmap(area)(theta)
    whole = area(np.pi / 2)
    np.testing.assert_allclose(found / whole, first, atol=3e-5 if source != "random" else 1e-6)


@pytest.mark.slow
def test_code_has_its_knots_in_an_array_and_says_how_it_was_made(table):
    source = ndf_source(table, "hlsl", name="Cloth")
    assert "float ClothHidden(float NdotV)" in source
    assert "static const float" in source
    assert "shadefit ndf ggx:0.2" in source


def test_code_needs_the_closed_form():
    with pytest.raises(ValueError, match="'cos2' only"):
        ndf_functions(random_profile(1))
