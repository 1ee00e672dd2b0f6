"""All toolchains, by the key of their language."""

from types import ModuleType

from programs.toolchains import (
    cuda,
    glsl,
    hlsl,
    javascript,
    metal,
    native,
    osl,
    python,
    slang,
    wgsl,
)
from programs.toolchains.interface import Toolchain


def _from_module(language: str, module: ModuleType) -> Toolchain:
    return Toolchain(language, module.missing_reason, module.evaluate, module.versions, module.NOTE)


TOOLCHAINS: dict[str, Toolchain] = {
    chain.language: chain
    for chain in (
        native.C,
        native.CPP,
        _from_module("hlsl", hlsl),
        _from_module("glsl", glsl),
        Toolchain("glsl-es", glsl.missing_reason_es, glsl.evaluate_es, glsl.versions, glsl.NOTE),
        _from_module("slang", slang),
        _from_module("metal", metal),
        _from_module("wgsl", wgsl),
        _from_module("osl", osl),
        _from_module("cuda", cuda),
        _from_module("python", python),
        _from_module("javascript", javascript),
    )
}


def toolchain(language: str) -> Toolchain:
    """Return the toolchain of a language (a key of LANGUAGES); raises ValueError for others."""
    if language not in TOOLCHAINS:
        raise ValueError(f"target is {language!r}; allowed: {', '.join(TOOLCHAINS)}")
    return TOOLCHAINS[language]
