"""Bundles that have a user interface: MaterialX, Blender's Script node and ISF."""

import json
import re
import sys
import xml.etree.ElementTree as ET
from importlib import import_module
from importlib.util import find_spec

import numpy as np
import pytest

from coefficients import exported_code
from coefficients.bundles import bundle
from coefficients.catalogue import resolve
from coefficients.code_options import CodeOptions
from coefficients.exported_code import exported_values, source_file
from fitting.points.grids import sobol_points
from programs import Parameter, function, toolchain
from programs.printing.node_graph import Argument, Node, Result
from programs.toolchains import osl
from programs.toolchains.process import execute, missing_command
from shadefit.cli import main
from tests.standard_nodes import evaluate_nodes

PS = ("alpha", "thetaF", "NdotU", "TdotU")
TABLES = ("best/ps-11", "best/g-9", "published/q")
# As in test_bundles.py: float32 against float64
ROUNDING = 1e-5
TOLD = {"Domain": 'a >= 1 & "b" < 2'}


@pytest.fixture
def written(monkeypatch):
    """Return a function that writes a bundle without measuring errors for its header."""
    monkeypatch.setattr(exported_code, "header_of", lambda *given: TOLD)

    def write(kind, *names, **options):
        chosen = bundle(kind)
        made = CodeOptions(interface="material", layout=chosen.layout, bundle=kind, **options)
        return source_file([resolve(name) for name in names], chosen.language, options=made)

    return write


def rows_and_values(name):
    entry = resolve(name)
    points = sobol_points(entry.axes, 6, 2)
    return np.concatenate(entry.arguments_at(points), axis=1), exported_values(entry, points)


def parsed_graph(graph):
    """Return the nodes and the value of a <nodegraph>, as `node_graph` does."""
    places = {}

    def source(element):
        if "interfacename" in element.attrib:
            return Argument(element.attrib["interfacename"])
        if "nodename" in element.attrib:
            return Result(places[element.attrib["nodename"]])
        return float(np.float32(element.attrib["value"]))

    *elements, output = graph
    nodes = []
    for place, element in enumerate(elements):
        assert element.attrib["type"] == "float"
        given = tuple((each.attrib["name"], source(each)) for each in element)
        nodes.append(Node(element.tag, given))
        places[element.attrib["name"]] = place
    return nodes, source(output)


def test_materialx_has_definitions_and_graphs_that_compute_the_tables(written):
    document = ET.fromstring(written("materialx", *TABLES))
    definitions, graphs = document.findall("nodedef"), document.findall("nodegraph")
    for name, definition, graph in zip(TABLES, definitions, graphs, strict=True):
        assert graph.attrib["nodedef"] == definition.attrib["name"]
        inputs = [each.attrib for each in definition.findall("input")]
        rows, exact = rows_and_values(name)
        given = dict(zip([each["name"] for each in inputs], rows.T, strict=True))
        for each in inputs:
            low, value, high = (float(each[key]) for key in ("uimin", "value", "uimax"))
            assert low < value < high
        nodes, value = parsed_graph(graph)
        np.testing.assert_allclose(
            evaluate_nodes(nodes, value, given), exact, rtol=0, atol=ROUNDING
        )
    told = definitions[0].attrib["doc"].split("\n")
    assert [line.strip() for line in told[1:]] == [
        "SPDX-License-Identifier: Apache-2.0",
        'Domain: a >= 1 & "b" < 2',
    ]
    assert [each.attrib["uiname"] for each in definitions[0].findall("input")] == [
        *("alpha", "thetaF (rad)", "NdotU", "TdotU")
    ]


def test_materialx_makes_glsl_that_computes_the_table(written, tmp_path):
    if find_spec("MaterialX") is None:
        pytest.skip("the package MaterialX is not here: make toolchains")
    mx, shaders = import_module("MaterialX"), import_module("MaterialX.PyMaterialXGenShader")
    generator = import_module("MaterialX.PyMaterialXGenGlsl").GlslShaderGenerator.create()
    document, library = mx.createDocument(), mx.createDocument()
    mx.readFromXmlString(document, written("materialx", *TABLES))
    assert document.validate() == (True, "")
    where = mx.getDefaultDataSearchPath()
    mx.loadLibraries(mx.getDefaultDataLibraryFolders(), where, library)
    document.importLibrary(library)
    assert document.validate() == (True, "")
    context = shaders.GenContext(generator)
    context.registerSourceCodeSearchPath(where)
    node = document.addNodeInstance(document.getNodeDef("ND_FuzzPs_float"), "fuzz")
    for name in PS:
        node.addInputFromNodeDef(name)
    made = generator.generate("fuzz", node, context).getSourceCode("pixel")
    if missing_command("glslangValidator", "glslang-tools") is None:
        (tmp_path / "fuzz.frag").write_text(made)
        execute(["glslangValidator", "fuzz.frag"], failure="fuzz.frag", folder=tmp_path)
    if toolchain("glsl").missing("float") is not None:
        return
    defined = "\n".join(re.findall(r"^#define mx_\w+ .*$", made, re.MULTILINE))
    (graph,) = re.findall(r"^void NG_FuzzPs_float\(.*?^}", made, re.DOTALL | re.MULTILINE)
    given = ", ".join(f"float {name}" for name in PS)
    called = f"float At({given}) {{ float y; NG_FuzzPs_float({', '.join(PS)}, y); return y; }}"
    rows, exact = rows_and_values("best/ps-11")
    got = run("glsl", f"{defined}\n{graph}\n{called}\n", "At", PS, rows)
    np.testing.assert_allclose(got, exact, rtol=0, atol=ROUNDING)


def test_materialx_refuses_options_of_code(written):
    for changed in ({"constants": "table"}, {"options": CodeOptions("material", "struct")}):
        options = changed.pop("options", CodeOptions("material"))
        options = CodeOptions("material", options.layout, bundle="materialx")
        with pytest.raises(ValueError, match="'materialx' holds no code"):
            source_file(resolve("best/ps-11"), "glsl", options=options, **changed)


def run(key, source, name, names, rows):
    called = function(name, [Parameter(each, (-9.0, 9.0)) for each in names], lambda *all: all[0])
    return toolchain(key).run(source, called, rows, "float")[:, 0]


def test_blender_has_a_shader_with_sliders(written, tmp_path):
    source = written("blender-osl", "best/ps-11")
    declared = re.findall(
        r"float (\w+) = (\S+)\s+\[\[ string label = (\".*?\"), float min = (\S+), "
        r"float max = (\S+) \]\],",
        source,
    )
    assert [each[0] for each in declared] == list(PS)
    assert declared[1][2] == '"thetaF (rad)"'
    assert all(float(low) < float(value) < float(high) for _, value, _, low, high in declared)
    if toolchain("osl").missing("float") is not None:
        pytest.skip("no compiler of OSL is here")
    if osl.renderer() is not None:
        (tmp_path / "probe0.osl").write_text(source)
        worker = [sys.executable, "-I", osl._WORKER, "compile", "0"]
        execute(worker, failure="probe0.osl", folder=tmp_path)
    # The toolchain runs functions, so the shader is made one.
    text = re.sub(r"\n *\[\[.*?\]\],", ",", source)
    text = re.sub(r" = [-\d.e]+,", ",", text).replace("shader FuzzPsNode", "float Shader")
    text = re.sub(r",\s*output float Value = 0\.0\)\n{", ")\n{\n    float Value = 0.0;", text)
    text = re.sub(r"(    Value = .*;\n)}", r"\1    return Value;\n}", text)
    rows, exact = rows_and_values("best/ps-11")
    given = run("osl", text, "Shader", PS, rows)
    # With Blender, cos is good to 1e-5.
    np.testing.assert_allclose(given, exact, rtol=0, atol=1e-4)


@pytest.mark.parametrize("name", TABLES)
def test_isf_compiles_in_browsers_and_on_desktops(name, written, tmp_path):
    source = written("isf", name)
    described = json.loads(source[2 : source.index("*/")])
    assert described["ISFVSN"] == "2"
    inputs = described["INPUTS"]
    assert all(each["MIN"] < each["DEFAULT"] < each["MAX"] for each in inputs)
    if missing_command("glslangValidator", "glslang-tools") is not None:
        pytest.skip("glslangValidator is not here")
    # What hosts put before the code
    uniforms = "".join(f"uniform {each['TYPE']} {each['NAME']};\n" for each in inputs)
    before = f"{uniforms}varying vec2 isf_FragNormCoord;\n"
    for version in ("100\nprecision highp float;", "120"):
        (tmp_path / "isf.frag").write_text(f"#version {version}\n{before}{source}")
        execute(["glslangValidator", "isf.frag"], failure="isf.frag", folder=tmp_path)
    (tmp_path / "isf.frag").write_text(f"#version 120\n{source}")
    with pytest.raises(Exception, match=r"isf\.frag"):
        execute(["glslangValidator", "isf.frag"], failure="isf.frag", folder=tmp_path)


@pytest.mark.slow
def test_isf_draws_a_curve(written):
    if toolchain("glsl").missing("float") is not None:
        pytest.skip("no compiler of GLSL is here")
    names = (*PS[:3], "top", "x", "y")
    given = ", ".join(f"float {each}" for each in names)
    text = written("isf", "best/ps-11").replace("void main()", f"float Picture({given})")
    text = text.replace("isf_FragNormCoord", "vec2(x, y)").replace("gl_FragColor =", "return")
    text = text.replace("vec4(vec3(shade), 1.0)", "shade")
    rows, exact = rows_and_values("best/ps-11")
    x = (rows[:, 3] + 1) / 2
    for factor, shade in ((0.99, 1.0), (1.01, 0.2)):
        y = exact / 2 * factor
        inside = (exact > 0.01) & (y < 1)
        columns = [*rows[:, :3].T, np.full(len(x), 2.0), x, y]
        drawn = run("glsl", text, "Picture", names, np.stack(columns, axis=1))
        assert inside.sum() > 30
        np.testing.assert_allclose(drawn[inside], shade, rtol=0, atol=1e-6)


@pytest.mark.parametrize("kind", ["isf", "blender-osl"])
def test_a_file_of_one_shader_refuses_several_tables(kind, written):
    with pytest.raises(ValueError, match=f"bundle '{kind}' is of 2 tables; allowed: one"):
        written(kind, "published/q", "best/g-9")


def test_the_command_line_has_the_options_of_the_bundle(written, capsys):
    with pytest.raises(SystemExit) as stopped:
        main(["export", "best/ps-11", "--bundle", "isf"])
    assert stopped.value.code == 0
    assert capsys.readouterr().out == written("isf", "best/ps-11")
