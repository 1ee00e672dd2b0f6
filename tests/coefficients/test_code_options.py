"""Choices about exported code: one interface for all tables, cosines, names, guards, files."""

import functools
import subprocess

import numpy as np
import pytest

from coefficients import exported_code
from coefficients.catalogue import entries, resolve
from coefficients.code_options import CodeOptions, prefixed, require_use, shaped, words_of
from coefficients.exported_code import exported_values, source_file, trial_of
from fitting.points.grids import sobol_points
from programs import check, toolchain, write_source
from quantities import problem

OF_PS = [entry.name for entry in entries(problem("ps"))]
MATERIAL = CodeOptions(interface="material")
# float64: the angle and its cosine differ in rounding, which steep forms multiply.
ROUNDING = 1e-10


@pytest.fixture
def few_points(monkeypatch):
    monkeypatch.setattr(exported_code, "trial_of", functools.partial(trial_of, exponent=8))


# The same two calls for every table


def calls_of(name, layout="array"):
    """Return the interface of a table's functions: names, arguments and structure."""
    first, second = shaped(resolve(name), CodeOptions("material", layout)).functions()
    assert (first.result_name, first.result) == ("material", second.parameters[0].size)
    records = {first.record.name, second.parameters[0].record.name}
    return [
        (each.name, [p.name for p in each.parameters], [p.unit for p in each.parameters], records)
        for each in (first, second)
    ]


@pytest.mark.slow
def test_every_table_of_p_s_and_its_closed_form_have_the_same_interface():
    expected = calls_of("published/ps")
    for name in [*OF_PS, "exact/ps"]:
        assert calls_of(name) == calls_of(name, "vec4") == expected
    for name in ("best/ps-11", "exact/ps"):
        source = write_source(shaped(resolve(name), MATERIAL).functions(), "hlsl")
        assert "\nFuzzMaterial FuzzPsMaterial(float alpha, float thetaF)\n" in source
        assert "\nfloat FuzzPs(FuzzMaterial material, float NdotU, float TdotU)\n" in source


@pytest.mark.parametrize("cosines", [False, True])
@pytest.mark.parametrize("name", ["ps", "best/ps-11", "best/ps-25", "best/ps-61-wide", "exact/ps"])
def test_the_interface_does_not_change_values(name, cosines):
    entry = resolve(name)
    points = sobol_points(entry.axes, 10, 3)
    options = CodeOptions(interface="material", layout="struct", cosines=cosines)
    given = exported_values(shaped(entry, options), points)
    if cosines or name.startswith("exact"):
        np.testing.assert_allclose(given, exported_values(entry, points), rtol=0, atol=ROUNDING)
    else:
        np.testing.assert_array_equal(given, exported_values(entry, points))


@pytest.mark.parametrize("key", ["c", "hlsl", "wgsl"])
@pytest.mark.parametrize("name", ["best/ps-11", "exact/ps"])
def test_code_with_a_material_passes(name, key):
    result = check(trial_of(shaped(resolve(name), MATERIAL), "float", 9), key)
    if result.status == "not checked":
        pytest.skip(result.reason)
    assert result.status == "passed", result.reason


# Cosines


@pytest.mark.parametrize("name", ["published/r", "best/r-25", "best/r-40-wide"])
def test_r_of_a_cosine_is_r_of_the_angle(name):
    entry = resolve(name)
    points = sobol_points(entry.axes, 10, 3)
    given = exported_values(shaped(entry, CodeOptions(cosines=True)), points)
    np.testing.assert_allclose(given, exported_values(entry, points), rtol=0, atol=ROUNDING)


@pytest.mark.parametrize("name", ["ps", "best/ps-11", "best/ps-40", "best/r-25", "published/r"])
def test_code_of_cosines_has_no_angles(name):
    source = write_source(shaped(resolve(name), CodeOptions(cosines=True)).functions(), "c")
    assert "NdotT" in source and "thetaF" not in source
    for angle in ("cosf(", "sinf(", "acosf("):
        assert angle not in source


def test_a_cosine_is_clamped_where_the_angle_is():
    # The published table is for angles from 0.1.
    for given, clamped in ((1.0, np.cos(0.1)), (-0.2, 0.0), (0.5, 0.5)):
        entry = shaped(resolve("published/ps"), CodeOptions(cosines=True))
        first = entry.functions()[0]
        np.testing.assert_allclose(
            first.call(0.5, given), first.call(0.5, clamped), rtol=0, atol=ROUNDING
        )


# Names, headers and files


def test_a_prefix_goes_before_every_name():
    entry = shaped(resolve("best/ps-11"), MATERIAL)
    first, second = prefixed(entry.functions(), "My")
    assert (first.name, second.name) == ("MyFuzzPsMaterial", "MyFuzzPs")
    assert "MyFuzzPs needs" in first.summary
    assert first.record.name == second.parameters[0].record.name == "MyFuzzMaterial"
    functions = entry.functions()
    assert prefixed(functions, "") is functions


@pytest.mark.parametrize(
    ("options", "quantities", "message"),
    [
        (CodeOptions(layout="vec4"), ["ps"], "allowed with interface material"),
        (MATERIAL, ["g", "q"], "is for tables of two functions: g, q has one"),
        (CodeOptions(cosines=True), ["g"], "cosines stand for angles: g takes no angle"),
    ],
)
def test_options_that_change_nothing_are_refused(options, quantities, message):
    with pytest.raises(ValueError, match=message):
        require_use(options, [problem(each) for each in quantities])
    require_use(options.__class__(), [problem(each) for each in quantities])


def test_options_become_words_of_the_command():
    options = CodeOptions("material", "vec4", True, "My", "fuzz")
    assert words_of(options) == [
        *("--interface", "material", "--layout", "vec4", "--prefix", "My"),
        *("--namespace", "fuzz", "--cosines"),
    ]
    assert words_of(CodeOptions()) == []


@pytest.mark.slow
def test_several_tables_are_one_file_with_a_header_each(few_points):
    listed = [resolve(name) for name in ("best/ps-11", "best/g-9", "q")]
    source = source_file(listed, "c", options=MATERIAL)
    assert source.startswith("// SPDX-License-Identifier: Apache-2.0\n// Quantity: P_s")
    assert source.count("SPDX") == 1
    assert source.count("\n// Quantity: ") == 3
    assert source.count("#include <math.h>") == 1
    made = "shadefit export best/ps-11 best/g-9 q --to c --interface material"
    assert made in " ".join(source.replace("//", "").split())
    for name in ("FuzzPsMaterial", "FuzzPs", "FuzzGApprox", "FuzzAveragePenetration"):
        assert f" {name}(" in source
    with pytest.raises(ValueError, match="function name 'FuzzGApprox' occurs twice"):
        source_file([resolve("g"), resolve("best/g-9")], "c")
    with pytest.raises(ValueError, match="name 'F' is for one table"):
        source_file(listed, "c", function_name="F")


@pytest.mark.parametrize(
    ("key", "suffix", "compiler"),
    [("c", "h", ["gcc", "-std=c99", "-pedantic"]), ("cpp", "hpp", ["g++", "-std=c++11"])],
)
def test_a_header_is_included_twice_and_in_two_translation_units(
    few_points, tmp_path, key, suffix, compiler
):
    if toolchain(key).missing("float") is not None:
        pytest.skip(f"{compiler[0]} is not here")
    listed = [resolve("best/ps-11"), resolve("best/g-9")]
    options = CodeOptions(interface="material", namespace="fuzz" if key == "cpp" else None)
    header = tmp_path / f"fuzz.{suffix}"
    header.write_text(source_file(listed, key, options=options))
    inside = "using namespace fuzz;\n" if key == "cpp" else ""
    one = f"""#include "{header.name}"
#include "{header.name}"
#include <stdio.h>
{inside}float other(float x);
int main(void) {{
    FuzzMaterial material = FuzzPsMaterial(0.35f, 0.785f);
    printf("%.6f %.6f", FuzzPs(material, 0.866f, 0.612f), other(0.5f));
    return 0;
}}
"""
    two = f'#include "{header.name}"\n{inside}float other(float x);\n'
    two += "float other(float x) { return FuzzGApprox(x, 0.2f); }\n"
    source = {f"one.{key}": one, f"two.{key}": two}
    for name, text in source.items():
        (tmp_path / name).write_text(text)
    strict = ["-Wall", "-Wextra", "-Werror", *source, "-o", "program", "-lm"]
    subprocess.run([*compiler, *strict], cwd=tmp_path, check=True)
    done = subprocess.run([tmp_path / "program"], capture_output=True, text=True, check=True)
    fraction, scattered = map(float, done.stdout.split())
    assert 0 < fraction < 1 and 0 < scattered < 1


def test_files_of_different_content_have_different_guards(few_points):
    sources = [
        source_file(resolve("q"), "c"),
        source_file(resolve("best/q-4"), "c"),
        source_file(resolve("q"), "c", "double"),
        source_file(resolve("q"), "c", options=CodeOptions(prefix="My")),
        source_file(resolve("q"), "c", function_name="Fn"),
    ]
    guards = [source.partition("#ifndef ")[2].partition("\n")[0] for source in sources]
    assert guards[0] == "SHADEFIT_Q"
    assert len(set(guards)) == len(guards)
