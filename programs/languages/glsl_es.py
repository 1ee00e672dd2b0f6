"""GLSL ES 3.00, the language of WebGL 2 and of mobile devices.

Each variable states its precision, so that the code does not depend on a default. Half precision is
`mediump`, which a device may compute in half or in float.
"""

from dataclasses import replace

from programs.languages.glsl import LANGUAGE as GLSL
from programs.languages.spelling import typed_triples

_TYPES = {"half": "mediump float", "float": "highp float"}

LANGUAGE = replace(
    GLSL,
    key="glsl-es",
    name="GLSL ES",
    types=_TYPES,
    literals=dict.fromkeys(_TYPES, "{}"),
    functions={precision: GLSL.functions[precision] for precision in _TYPES},
    clamps={precision: GLSL.clamps[precision] for precision in _TYPES},
    prologue=dict.fromkeys(_TYPES, ()),
    vectors={"half": "mediump vec4", "float": "highp vec4"},
    triples=typed_triples({"half": "mediump vec3", "float": "highp vec3"}),
    table_opening="const {type} {name}[{size}] = float[{size}](",
)
