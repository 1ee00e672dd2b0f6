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
from programs.languages.spelling import PRECISIONS as PRECISIONS
from programs.languages.spelling import Spelling as Spelling
from programs.languages.spelling import Language as Language
from programs.languages.spelling import shortest as shortest_decimal

LANGUAGES: dict[str, Language] = {
    module.LANGUAGE.key: module.LANGUAGE
    for module in (c, cpp, hlsl, glsl, slang, metal, wgsl, osl, cuda, python, javascript)
}


def target(key: str) -> Language:
    """Give the target of a key; raises ValueError for one that there is none of."""
    if key not in LANGUAGES:
        raise ValueError(f"target {key!r} is unknown; allowed: {', '.join(LANGUAGES)}")
    return LANGUAGES[key]
