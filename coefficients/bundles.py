"""Ready files for programs that host shaders: exported code with the entry points that they call.

* "shadertoy": an image shader for Shadertoy, which draws the function.
* "isf": a generator in the Interactive Shader Format, which draws it, with sliders.
* "unity": an include for Custom Function nodes of Unity's Shader Graph.
* "unreal": an include for Custom nodes of Unreal's material editor.
* "materialx": a document with a node definition and a graph of standard nodes for each table.
* "blender-osl": a shader for Blender's Script node.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from coefficients import entry_points
from coefficients.bundle_documents import isf_document, materialx_document
from coefficients.entry_points import Tables
from programs.functions import Layout


@dataclass(frozen=True)
class Bundle:
    """A kind of bundle.

    * `language`: of the code.
    * `code`: maps the functions of all tables, in the order of their calls, to the blocks of lines
      after them.
    * `document`: makes the file from these functions, the headers of the tables and the source.
      None: the file is the source.
    * `layout`: of structures, unless another one is asked for.
    * `several`: whether a file may have more than one table.
    * `holds_code`: whether the file has the code, which can be run to measure its error.
    """

    language: str
    code: Callable[[Tables], list[list[str]]]
    document: Callable[[Tables, Sequence[Mapping[str, str]], str], str] | None = None
    layout: Layout = "array"
    several: bool = True
    holds_code: bool = True


def bundle(kind: str) -> Bundle:
    """Return a kind of bundle. Raises ValueError for a kind that is not known."""
    if kind not in BUNDLES:
        raise ValueError(f"bundle {kind!r} is unknown; allowed: {', '.join(BUNDLES)}")
    return BUNDLES[kind]


def language_of_bundle(kind: str) -> str:
    """Return the key of the language of a kind of bundle. Raises ValueError as `bundle` does."""
    return bundle(kind).language


BUNDLES: dict[str, Bundle] = {
    "shadertoy": Bundle("glsl-es", entry_points.shadertoy),
    # GLSL ES 1.00, which browsers use, returns no structures that contain arrays.
    "isf": Bundle("glsl", entry_points.isf, isf_document, layout="struct", several=False),
    "unity": Bundle("hlsl", entry_points.unity),
    "unreal": Bundle("hlsl", entry_points.unreal),
    "materialx": Bundle("glsl", lambda tables: [], materialx_document, holds_code=False),
    "blender-osl": Bundle("osl", entry_points.blender_shader, several=False),
}
