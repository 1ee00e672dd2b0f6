"""Every language's toolchain by its target's name."""

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


def _assembled(target: str, module: ModuleType) -> Toolchain:
    return Toolchain(target, module.missing_reason, module.evaluate, module.versions, module.NOTE)


TOOLCHAINS: dict[str, Toolchain] = {
    chain.target: chain
    for chain in (
        native.C,
        native.CPP,
        _assembled("hlsl", hlsl),
        _assembled("glsl", glsl),
        _assembled("slang", slang),
        _assembled("metal", metal),
        _assembled("wgsl", wgsl),
        _assembled("osl", osl),
        _assembled("cuda", cuda),
        _assembled("python", python),
        _assembled("javascript", javascript),
    )
}


def toolchain(target: str) -> Toolchain:
    """Give a language's toolchain.

    Arguments: `target`, a language's name as in the registry of targets. Raises ValueError for a
    language that has none.
    """
    if target not in TOOLCHAINS:
        raise ValueError(f"target is {target!r}; allowed: {', '.join(TOOLCHAINS)}")
    return TOOLCHAINS[target]
