"""The table of an NDF, and its code: read back, refused if hostile, and run."""

import json

import numpy as np
import pytest

from coefficients.ndf_code import check_ndf, ndf_source, ndf_trials, profile_of
from coefficients.ndf_table import SCHEMA, NdfErrors, NdfTable, read_ndf, serialise_ndf
from programs import precision_of, toolchain
from quantities.piecewise.code import ndf_functions
from quantities.piecewise.knots import equidistributed_knots
from quantities.piecewise.targets import analytic_ndf
from shading.piecewise.moments import normalised
from shading.piecewise.ndf import profile
from tests.integrals.piecewise_examples import random_profile


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
    with pytest.raises(ValueError, match="no such file"):
        read_ndf(tmp_path / "none.json")
    (tmp_path / "text.json").write_text("[" * 100_000)
    with pytest.raises(ValueError, match=r"text\.json"):
        read_ndf(tmp_path / "text.json")


@pytest.mark.slow
def test_code_has_the_values_of_the_library(table):
    """In float64 only the arctangent's polynomial and the rounding of float32 inputs differ."""
    limits = {"NdfD": 3e-5, "NdfHidden": 6e-7, "NdfVisibility": 3e-6, "NdfSquaredSine": 1e-7}
    for trial in ndf_trials(profile_of(table), "float"):
        (function,) = trial.calls.functions
        found = trial.emulated(np.float64)
        assert np.abs(found - trial.integral).max() < limits[function.name], function.name


@pytest.mark.slow
def test_a_profile_with_gaps_has_code_too():
    ndf = normalised(
        profile(
            np.array([0, 0.3, 0.5, 0.9, 1.2, np.pi / 2]), np.array([0.0, 0, 1, 0, 0, 0]), "cos2"
        )
    )
    for trial in ndf_trials(ndf, "float"):
        assert np.abs(trial.emulated(np.float32) - trial.integral).max() < 2e-5


@pytest.mark.slow
@pytest.mark.parametrize("key", ["c", "javascript"])
def test_code_is_run(table, key):
    if toolchain(key).missing(precision_of(key, None)) is not None:
        pytest.skip(f"{key} is not installed")
    assert [each.status for each in check_ndf(table, key)] == ["passed"] * 4


@pytest.mark.slow
def test_code_is_the_same_bytes_with_its_knots_in_an_array(table):
    source = ndf_source(table, "hlsl", name="Cloth")
    assert source == ndf_source(table, "hlsl", name="Cloth")
    assert "float ClothHidden(float NdotV)" in source
    assert "static const float" in source
    assert "shadefit ndf ggx:0.2" in source


def test_code_needs_the_closed_form():
    with pytest.raises(ValueError, match="'cos2' only"):
        ndf_functions(random_profile(1))
