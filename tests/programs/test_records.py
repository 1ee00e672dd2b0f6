"""Structures that one function returns and another takes, in every language that has them."""

from dataclasses import replace

import jax.numpy as jnp
import numpy as np
import pytest

from programs import (
    LANGUAGES,
    CallSequence,
    Parameter,
    Record,
    Trial,
    check,
    function,
    write_source,
)
from programs.functions import Layout
from programs.printing.printer import Section, write_sections

UNIT = (0.0, 1.0)


def both(record):
    """Return two functions: five numbers of x, and their polynomial in y."""
    first = function(
        "BlobMaterial",
        [Parameter("x", UNIT)],
        lambda x: (x, x * x, 1.0 - x, 0.5 * x, x + 1.0),
        result=5,
        result_name="material",
        record=record,
    )
    second = function(
        "Blob",
        [Parameter("material", UNIT, size=5, record=record), Parameter("y", UNIT)],
        lambda m, y: m[0] + y * (m[1] + y * (m[2] + y * (m[3] + y * jnp.sqrt(m[4])))),
    )
    return first, second


def trial(record, precision):
    points = np.random.default_rng(4).uniform(0, 1, (64, 2))
    calls = CallSequence(both(record), lambda rows: (rows[:, :1], rows[:, 1:]))
    return Trial(calls, points, precision)


LAYOUTS: tuple[Layout, ...] = ("array", "struct", "vec4")
CASES = [
    (key, precision, layout)
    for key, spelled in LANGUAGES.items()
    for precision in spelled.types
    for layout in LAYOUTS
    if (layout == "array" or spelled.record_opening is not None)
    and (layout != "vec4" or precision in spelled.vectors)
    and (key != "cuda" or precision == "float")
    # These have no root of doubles.
    and (precision != "double" or key != "hlsl")
]


def _marks(key, precision, layout):
    """Leave what is alike to the slow tests, and CUDA, whose compiler takes seconds for a file."""
    alike = precision != "float" and key not in ("c", "hlsl")
    return [pytest.mark.slow] if key == "cuda" or alike else []


@pytest.mark.parametrize(
    ("key", "precision", "layout"),
    [pytest.param(*case, marks=_marks(*case)) for case in CASES],
)
def test_a_structure_holds_what_the_first_function_computed(key, precision, layout):
    result = check(trial(Record("BlobState", layout, "k"), precision), key)
    if result.status == "not checked":
        pytest.skip(result.reason)
    assert result.status == "passed", result.reason


@pytest.mark.parametrize(
    ("layout", "declared", "read"),
    [
        ("array", "float k[5];", "material.k[4]"),
        ("struct", "float k4;", "material.k4"),
        ("vec4", "float4 k1;", "material.k1.x"),
    ],
)
def test_the_layouts_in_hlsl(layout, declared, read):
    source = write_source(both(Record("BlobState", layout, "k")), "hlsl")
    assert source.count("struct BlobState {") == 1
    assert declared in source and read in source
    assert "BlobState BlobMaterial(float x)" in source
    assert "float Blob(BlobState material, float y)" in source
    # The rest of the last vector has a value too.
    assert source.count("= 0.0f;") == (3 if layout == "vec4" else 0)


def test_python_and_javascript_have_a_tuple_and_an_array():
    source = write_source(both(Record("BlobState")), "python")
    assert "BlobState" not in source and "def Blob(material, y):" in source
    for key, precision in (("python", "float"), ("javascript", "double")):
        with pytest.raises(ValueError, match=r"layout 'struct' is not in .* allowed: array$"):
            write_source(both(Record("BlobState", "struct")), key, precision)


def test_a_layout_that_a_language_does_not_have_is_refused():
    with pytest.raises(ValueError, match="layout 'vec4' is not in C at float precision"):
        write_source(both(Record("BlobState", "vec4")), "c")


@pytest.mark.parametrize("name", ["2x", "a b"])
def test_names_of_structures_and_members_are_identifiers(name):
    with pytest.raises(ValueError, match="no identifier"):
        Record(name)
    with pytest.raises(ValueError, match="no identifier"):
        Record("Good", "array", name)


def test_a_structures_name_is_no_functions_name_and_no_reserved_word():
    for name, message in (("Blob", "is a function"), ("float4", "cannot be used in HLSL")):
        with pytest.raises(ValueError, match=message):
            write_source(both(Record(name)), "hlsl")


def test_sections_share_a_structure_but_not_its_name():
    first, second = both(Record("BlobState"))
    sections = [Section((first,), {"One": "1"}), Section((second,), {"Two": "2"})]
    source = write_sections(sections, "c", guard="BLOB_H")
    assert source.count("typedef struct BlobState") == 1
    assert source.index("// One: 1") < source.index("#ifndef BLOB_H") < source.index("// Two: 2")
    assert source.endswith("#endif // BLOB_H\n")
    assert "#ifndef" not in write_sections(sections, "wgsl", guard="BLOB_H")
    other = replace(second, parameters=both(Record("BlobState", "struct"))[1].parameters)
    with pytest.raises(ValueError, match="structure 'BlobState' occurs twice"):
        write_sections([sections[0], Section((other,), {})], "c")


def test_a_namespace_is_for_languages_that_have_one():
    section = Section(both(Record("BlobState")), {})
    source = write_sections([section], "cpp", namespace="blob")
    assert "namespace blob {\n" in source and source.endswith("} // namespace blob\n")
    with pytest.raises(ValueError, match="namespace 'blob' is not possible in GLSL"):
        write_sections([section], "glsl", namespace="blob")
