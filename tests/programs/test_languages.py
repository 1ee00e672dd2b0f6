"""The registry of languages: keys, default precisions, and imports that stay cheap."""

import subprocess
import sys

import pytest

from programs.languages import (
    LANGUAGES,
    PRECISIONS,
    language,
    language_of_file,
    precision_of,
    require_suffix,
)
from programs.languages.registry import ALIASES, SUFFIXES
from programs.toolchains import TOOLCHAINS


def test_every_language_has_a_toolchain_and_known_precisions():
    assert list(LANGUAGES) == list(TOOLCHAINS)
    for key, spelled in LANGUAGES.items():
        assert spelled.key == TOOLCHAINS[key].language == key
        assert set(spelled.types) <= set(PRECISIONS)
        assert (
            spelled.types.keys()
            == spelled.literals.keys()
            == spelled.functions.keys()
            == spelled.prologue.keys()
        )
    assert len({spelled.name for spelled in LANGUAGES.values()}) == len(LANGUAGES)


def test_a_language_is_found_by_its_key():
    assert language("hlsl").name == "HLSL"
    with pytest.raises(ValueError, match="target 'klingon' is unknown; allowed: c, cpp, hlsl, "):
        language("klingon")


@pytest.mark.parametrize(
    ("name", "key"),
    [
        ("c++", "cpp"), ("C++", "cpp"), ("GLSL", "glsl"), ("Js", "javascript"), ("py", "python"),
        ("webgl", "glsl-es"), ("ESSL", "glsl-es"), ("MSL", "metal"), ("cu", "cuda"),
    ],
)  # fmt: skip
def test_a_language_has_other_names_in_any_case(name, key):
    assert language(name).key == key
    assert precision_of(name, None) == precision_of(key, None)


def test_aliases_and_suffixes_are_those_of_languages():
    assert set(ALIASES.values()) <= set(LANGUAGES)
    assert not set(ALIASES) & set(LANGUAGES)
    assert all(set(keys) <= set(LANGUAGES) for keys in SUFFIXES.values())
    for key, spelled in LANGUAGES.items():
        assert key in SUFFIXES[spelled.extension]


@pytest.mark.parametrize(
    ("file", "key"),
    [
        ("fuzz.hlsl", "hlsl"), ("Fuzz.HLSLI", "hlsl"), ("a.b.ush", "hlsl"), ("x.frag", "glsl"),
        ("x.hpp", "cpp"), ("x.c", "c"), ("x.mjs", "javascript"), ("x.txt", None), ("hlsl", None),
    ],
)  # fmt: skip
def test_the_suffix_of_a_file_names_a_language(file, key):
    assert language_of_file(file) == key


def test_a_suffix_of_several_languages_names_none():
    with pytest.raises(ValueError, match=r"\.h is the suffix of several languages; allowed with"):
        language_of_file("fuzz.h")
    for key in ("c", "cpp", "metal"):
        require_suffix("fuzz.h", key)
    require_suffix("fuzz.inc", "wgsl")
    with pytest.raises(ValueError, match=r"'fuzz\.hlsl' is no name for GLSL; allowed .* hlsl"):
        require_suffix("fuzz.hlsl", "glsl")


def test_the_default_precision_is_float_where_there_is_one():
    assert precision_of("c", None) == "float"
    assert precision_of("javascript", None) == "double"
    assert precision_of("c", "half") == "half"
    with pytest.raises(ValueError, match="precision 'double' is not in WGSL; allowed: half, float"):
        precision_of("wgsl", "double")
    with pytest.raises(ValueError, match="target 'klingon' is unknown"):
        precision_of("klingon", None)


def test_languages_are_imported_without_jax():
    code = "import sys; from programs import LANGUAGES; print('jax' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "False\n"
