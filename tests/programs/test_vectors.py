"""Vectors of three numbers as arguments and results, in every language."""

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

UNIT = (0.0, 1.0)


def blend(record=None):
    """Return a function of a vector, three vectors and a number, with two vectors as results."""

    def call(axis, lights, share):
        heights = [sum(axis[k] * lights[3 * i + k] for k in range(3)) for i in range(3)]
        return (*heights, *(share * lights[k] for k in range(3)))

    parameters = [
        Parameter("axisWS", UNIT, size=3, shape="vector"),
        Parameter("lights", UNIT, size=9, shape="vectors"),
        Parameter("share", UNIT),
    ]
    record = record or Record("Blended", vectors=("heights", "scaled"))
    return function("Blend", parameters, call, "A blend.", 6, "blended", record)


def trial(precision):
    points = np.random.default_rng(4).uniform(0, 1, (64, 13))
    return Trial(CallSequence((blend(),), lambda rows: (rows,)), points, precision)


CASES = [(key, kind) for key, spelled in LANGUAGES.items() for kind in spelled.types]
# In float every language is alike, so the other precisions are slow tests, and CUDA, whose compiler
# takes seconds for a file.
MARKED = [
    pytest.param(*case, marks=[pytest.mark.slow] if slow else [])
    for case in CASES
    for slow in (
        case[0] == "cuda" or case[1] != ("double" if case[0] == "javascript" else "float"),
    )
]


@pytest.mark.parametrize(("key", "precision"), MARKED)
def test_code_with_vectors_passes(key, precision):
    result = check(trial(precision), key)
    if result.status == "not checked":
        pytest.skip(result.reason)
    assert result.status == "passed", result.reason


@pytest.mark.parametrize(
    ("key", "texts"),
    [
        ("hlsl", ("float3 axisWS, in float3 lights[3]", "float3 heights;", "lights[2].z")),
        ("glsl", ("vec3 axisWS, in vec3 lights[3]", "vec3 heights;", "lights[2].z")),
        ("glsl-es", ("highp vec3 axisWS", "highp vec3 scaled;")),
        ("wgsl", ("axisWS: vec3<f32>", "array<vec3<f32>, 3>", "heights: vec3<f32>,")),
        ("metal", ("float3 axisWS", "thread const float3 (&lights)[3]", "float3 heights;")),
        ("cuda", ("float3 axisWS", "const float3 (&lights)[3]", "blended.heights.x =")),
        ("osl", ("vector axisWS, vector lights[3]", "vector heights;", "blended.heights[0] =")),
        ("c", ("const float axisWS[3], const float lights[3][3]", "float heights[3];")),
        ("cpp", ("const float (&axisWS)[3]", "const float (&lights)[3][3]", "lights[2][1]")),
        ("python", ("def Blend(axisWS, lights, share):", "return ((", "lights[2][1]")),
    ],
)
def test_how_vectors_are_written(key, texts):
    source = write_source(blend(), key)
    unbroken = " ".join(source.split())
    for text in texts:
        assert text in unbroken


def test_javascript_returns_two_arrays():
    assert "return [[" in write_source(blend(), "javascript", "double")


@pytest.mark.parametrize(
    ("size", "shape"), [(None, "vector"), (2, "vector"), (4, "vectors"), (None, "vectors")]
)
def test_sizes_that_vectors_cannot_have_are_refused(size, shape):
    with pytest.raises(ValueError, match="allowed: 3 for a vector, a multiple of 3 for vectors"):
        Parameter("axisWS", UNIT, size=size, shape=shape)


def test_names_of_vectors_are_identifiers_and_no_reserved_words():
    with pytest.raises(ValueError, match="name 'shared' cannot be used in GLSL"):
        write_source(blend(Record("Blended", vectors=("heights", "shared"))), "glsl")
    with pytest.raises(ValueError, match="member name '3d' is no identifier"):
        Record("Good", vectors=("fine", "3d"))
