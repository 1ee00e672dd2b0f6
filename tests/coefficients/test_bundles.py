"""Files for programs that host shaders, compiled by the compilers that these programs use."""

import functools

import numpy as np
import pytest

from coefficients import exported_code
from coefficients.bundles import BUNDLES, language_of_bundle
from coefficients.catalogue import resolve
from coefficients.code_options import CodeOptions
from coefficients.exported_code import exported_values, source_file, trial_of
from fitting.points.grids import sobol_points
from programs import Parameter, function, toolchain, write_source
from programs.printing.printer import Section, write_sections
from programs.toolchains.process import execute, missing_command

NAMES = ("best/ps-11", "best/g-9", "q")
PS = ("alpha", "thetaF", "NdotU", "TdotU")
# float32 of the device against float64; P_s multiplies the rounding of its arguments.
ROUNDING = 1e-5


@functools.cache
def written(kind):
    few = functools.partial(trial_of, exponent=6)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(exported_code, "trial_of", few)
        options = CodeOptions(interface="material", bundle=kind)
        listed = [resolve(name) for name in NAMES]
        return source_file(listed, language_of_bundle(kind), options=options)


def run_in_hlsl(source, name):
    """Run a function of P_s, given by its name, at random points; return its and exact values."""
    if toolchain("hlsl").missing("float") is not None:
        pytest.skip("no compiler of HLSL is here")
    called = function(name, [Parameter(each, (-1.0, 1.6)) for each in PS], lambda *given: given[0])
    entry = resolve("best/ps-11")
    points = sobol_points(entry.axes, 6, 2)
    rows = np.concatenate(entry.arguments_at(points), axis=1)
    given = toolchain("hlsl").run(source, called, rows, "float")[:, 0]
    return given, exported_values(entry, points)


def test_unreal_calls_one_function(kind="unreal"):
    source = written(kind)
    assert "//   return FuzzPsAt(alpha, thetaF, NdotU, TdotU);" in source
    np.testing.assert_allclose(*run_in_hlsl(source, "FuzzPsAt"), rtol=0, atol=ROUNDING)


@pytest.mark.parametrize("real", ["float", "half"])
def test_unity_calls_a_function_with_a_result_argument(real):
    source = written("unity")
    assert f"void FuzzPs_{real}({real} alpha, {real} thetaF," in source
    names = ", ".join(PS)
    given = ", ".join(f"float {each}" for each in PS)
    # Shader Graph declares a variable and passes it.
    source += f"float Graph({given})\n{{\n    {real} Out;\n    FuzzPs_{real}({names}, Out);\n"
    source += "    return Out;\n}\n"
    # DXC has 16 bits for half here; the cosines are rounded to them.
    most = ROUNDING if real == "float" else 0.02
    np.testing.assert_allclose(*run_in_hlsl(source, "Graph"), rtol=0, atol=most)


def test_shadertoy_compiles_as_an_image_shader(tmp_path):
    if missing_command("glslangValidator", "glslang-tools") is not None:
        pytest.skip("glslangValidator is not here")
    # What Shadertoy puts before and after the code of a tab.
    before = "#version 300 es\nprecision highp float;\nuniform vec3 iResolution;\nout vec4 color;\n"
    after = "void main() { mainImage(color, gl_FragCoord.xy); }\n"
    source = written("shadertoy")
    assert "FuzzPs(FuzzPsMaterial(alpha, thetaF), NdotU, TdotU)" in source
    (tmp_path / "image.frag").write_text(before + source + after)
    execute(["glslangValidator", "image.frag"], failure="image.frag", folder=tmp_path)
    (tmp_path / "image.frag").write_text(before + source.replace("mix(", "max(") + after)
    with pytest.raises(Exception, match=r"image\.frag"):
        execute(["glslangValidator", "image.frag"], failure="image.frag", folder=tmp_path)


def test_a_bundle_has_its_own_language():
    assert {kind: language_of_bundle(kind) for kind in BUNDLES} == {
        "shadertoy": "glsl-es",
        "isf": "glsl",
        "unity": "hlsl",
        "unreal": "hlsl",
        "materialx": "glsl",
        "blender-osl": "osl",
    }
    with pytest.raises(ValueError, match="bundle 'godot' is unknown; allowed: shadertoy, isf"):
        language_of_bundle("godot")
    for key, precision in (("glsl", None), ("hlsl", "half")):
        with pytest.raises(ValueError, match="allowed is hlsl in float"):
            source_file(resolve("q"), key, precision, options=CodeOptions(bundle="unity"))


# The names that bundles give to local variables and results, or call, and a problem that has them
TAKEN = ("x", "value", "column", "y", "shade", "top", "Out", "Value")


@functools.cache
def with_taken_names(kind):
    bundle = BUNDLES[kind]
    called = function("Sum", [Parameter(name, (0.0, 1.0)) for name in TAKEN], lambda *x: sum(x))
    return write_sections(
        [Section((called,), {})], bundle.language, ending=bundle.code([(called,)])
    )


def test_variables_of_a_bundle_hide_no_argument(tmp_path):
    shadertoy = with_taken_names("shadertoy")
    assert "value_2 = Sum(x, value, column, y, shade, top, Out, Value);" in shadertoy
    assert "highp float x = mix(0.0, 1.0, x_2);" in shadertoy
    assert "highp float Value = mix(0.0, 1.0, y_2);" in shadertoy
    isf = with_taken_names("isf")
    assert "float shade_2 = isf_FragNormCoord.y * top_2 < value_2 ? 1.0 : 0.2;" in isf
    assert "out half Out_2)\n" in with_taken_names("unity")
    assert "float Value_2 = 0.0)\n" in with_taken_names("blender-osl")
    if missing_command("glslangValidator", "glslang-tools") is None:
        before = "#version 300 es\nprecision highp float;\nuniform vec3 iResolution;\n"
        after = "out vec4 color;\nvoid main() { mainImage(color, gl_FragCoord.xy); }\n"
        (tmp_path / "image.frag").write_text(before + shadertoy + after)
        execute(["glslangValidator", "image.frag"], failure="image.frag", folder=tmp_path)


def test_an_argument_has_no_name_that_a_bundle_calls():
    called = function("Half", [Parameter("mix", (0.0, 1.0))], lambda x: 0.5 * x)
    assert "float Half(highp float mix)" in write_source(called, "glsl-es")
    with pytest.raises(ValueError, match="name 'mix' cannot be used in GLSL ES; allowed: "):
        write_sections(
            [Section((called,), {})], "glsl-es", ending=BUNDLES["shadertoy"].code([(called,)])
        )
