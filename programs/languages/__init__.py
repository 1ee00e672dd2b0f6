"""The languages that functions are written in: one file a language, one line in the table.

A target says how a language is spelled: its types, literals, functions, signatures and reserved
words. What a function computes is none of its business.
"""

from programs.languages import (
    c,
    cpp,
    cuda,
    glsl,
    hlsl,
    javascript,
    metal,
    osl,
    python,
    slang,
    wgsl,
)
from programs.languages.language import PRECISIONS as PRECISIONS
from programs.languages.language import Spelling as Spelling
from programs.languages.language import Target as Target
from programs.languages.language import shortest as shortest

TARGETS: dict[str, Target] = {
    module.TARGET.key: module.TARGET
    for module in (c, cpp, hlsl, glsl, slang, metal, wgsl, osl, cuda, python, javascript)
}


def target(key: str) -> Target:
    """Give the target of a key; raises ValueError for one that there is none of."""
    if key not in TARGETS:
        raise ValueError(f"target {key!r} is unknown; allowed: {', '.join(TARGETS)}")
    return TARGETS[key]
