"""All languages, by key."""

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
from programs.languages.spelling import Language

LANGUAGES: dict[str, Language] = {
    module.LANGUAGE.key: module.LANGUAGE
    for module in (c, cpp, hlsl, glsl, slang, metal, wgsl, osl, cuda, python, javascript)
}


def language(key: str) -> Language:
    """Return the language with a key; raises ValueError for an unknown key."""
    if key not in LANGUAGES:
        raise ValueError(f"target {key!r} is unknown; allowed: {', '.join(LANGUAGES)}")
    return LANGUAGES[key]


def precision_of(key: str, wanted: str | None) -> str:
    """Return the precision to write a language in: the wanted one, or the default for None.

    The default is "float", or the first precision of a language that does not have it. Raises
    ValueError for an unknown language, and for a precision that the language does not have.
    """
    spelled = language(key)
    if wanted is None:
        return "float" if "float" in spelled.types else next(iter(spelled.types))
    if wanted not in spelled.types:
        raise ValueError(
            f"precision {wanted!r} is not in {spelled.name}; allowed: {', '.join(spelled.types)}"
        )
    return wanted
