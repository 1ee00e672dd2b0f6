"""All languages, by key."""

from programs.languages import (
    c,
    cpp,
    cuda,
    glsl,
    glsl_es,
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
    for module in (c, cpp, hlsl, glsl, glsl_es, slang, metal, wgsl, osl, cuda, python, javascript)
}


# Other names of languages, in lower case
ALIASES = {
    "c++": "cpp",
    "cxx": "cpp",
    "cu": "cuda",
    "essl": "glsl-es",
    "gles": "glsl-es",
    "glsles": "glsl-es",
    "webgl": "glsl-es",
    "msl": "metal",
    "js": "javascript",
    "py": "python",
    "numpy": "python",
}
# The ends of files' names -> the languages that such files may have. The first is the one that a
# name without further information stands for; with several of equal right there is none.
SUFFIXES: dict[str, tuple[str, ...]] = {
    "c": ("c",),
    "h": ("c", "cpp", "cuda", "metal", "osl", "hlsl", "glsl"),
    **dict.fromkeys(("cpp", "hpp", "cc", "hh", "cxx", "hxx"), ("cpp",)),
    **dict.fromkeys(("hlsl", "hlsli", "fx", "fxh", "cginc", "ush", "usf"), ("hlsl", "slang")),
    **dict.fromkeys(("glsl", "vert", "frag", "comp", "fs", "vs"), ("glsl", "glsl-es")),
    "slang": ("slang",),
    "metal": ("metal",),
    "wgsl": ("wgsl",),
    "osl": ("osl",),
    **dict.fromkeys(("cu", "cuh"), ("cuda",)),
    "py": ("python",),
    **dict.fromkeys(("js", "mjs"), ("javascript",)),
}
# Suffixes that do not decide between the languages
_AMBIGUOUS = ("h",)


def language(key: str) -> Language:
    """Return the language with a key or another name, in any case.

    Raises ValueError for a name that is not known.
    """
    name = key.lower()
    name = ALIASES.get(name, name)
    if name not in LANGUAGES:
        raise ValueError(f"target {key!r} is unknown; allowed: {', '.join(LANGUAGES)}")
    return LANGUAGES[name]


def language_of_file(name: str) -> str | None:
    """Return the key of the language that a file's name stands for.

    Returns None for a name without a suffix of any language. Raises ValueError for a suffix that
    several languages share.
    """
    suffix = name.rpartition(".")[2].lower() if "." in name else ""
    if suffix in _AMBIGUOUS:
        allowed = ", ".join(SUFFIXES[suffix])
        raise ValueError(
            f".{suffix} is the suffix of several languages; allowed with --to: {allowed}"
        )
    return SUFFIXES[suffix][0] if suffix in SUFFIXES else None


def require_suffix(name: str, key: str) -> None:
    """Raise ValueError if a file's name has the suffix of other languages than `key`."""
    suffix = name.rpartition(".")[2].lower() if "." in name else ""
    if key not in SUFFIXES.get(suffix, (key,)):
        raise ValueError(
            f"{name!r} is no name for {LANGUAGES[key].name}; allowed with this suffix: "
            f"{', '.join(SUFFIXES[suffix])}"
        )


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
