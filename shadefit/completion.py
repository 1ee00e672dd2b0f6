"""Completion in the shell: names of quantities, tables, closed forms and languages.

The names come from the names of the tables' files and from the lists below. They do not come
from the registry, because it imports JAX, and every press of the tab key would wait for that. Tests
compare the lists with the registry.
"""

from pathlib import Path

_TABLES = Path(__file__).parent.parent / "coefficients" / "tables"
_GGX = ("ggx-directional-albedo", "ggx-scale", "ggx-bias", "ggx-average-albedo")
_MAPS = ("sggx-filter", "sggx-filter-axes")
_CHANNELS = ("red", "green", "blue")
_SKIN = (
    *(f"skin-{surface}-{channel}" for surface in ("cylinder", "sphere") for channel in _CHANNELS),
    *("skin-lobe-cylinder", "skin-lobe-sphere"),
    *(f"skin-band-{band}-{channel}" for band in (1, 2) for channel in _CHANNELS),
)
# The quantities in the order of the registry, and the closed forms to export.
QUANTITIES = ("ps", "g", "q", "r", "velvet", *_GGX, *_MAPS, *_SKIN)
EXACT = ("exact/ps", "exact/g", "exact/q", "exact/velvet")
_SAMPLERS = (
    "sampler/ggx-upper",
    "sampler/ggx-upper-pdf",
    "sampler/ggx-bounded-cap",
    "sampler/ggx-bounded-cap-pdf",
    "sampler/ggx-cap",
    "sampler/ggx-cap-pdf",
    "sampler/ggx-disk",
    "sampler/ggx-disk-pdf",
)
_ENCODINGS = ("published", "stereographic", "quarter-root", "logarithmic")
_DECODERS = tuple(f"decode/aniso-{name}{end}" for name in _ENCODINGS for end in ("", "-matrix"))
_BLENDS = ("overlay", "smooth-overlay", "symmetric-overlay")
_OPERATORS = tuple(f"detail/{name}{end}" for name in _BLENDS for end in ("", "-inverse"))
_CURVATURES = tuple(
    f"curvature/{name}"
    for name in (
        "from-light",
        "along-light",
        "effective",
        "equivalent-cylinder",
        "pack",
        "unpack",
    )
)
_AMBIENT = tuple(f"ambient/{name}" for name in ("talk", "cheap", "recommended"))
# Functions that are exported, but not fitted.
FUNCTIONS = (*_SAMPLERS, *_DECODERS, *_OPERATORS, *_CURVATURES, *_AMBIENT)


def complete_quantity(incomplete: str) -> list[str]:
    """Complete the name of a quantity, or 'all'."""
    return [name for name in (*QUANTITIES, "all") if name.startswith(incomplete)]


def complete_table(incomplete: str) -> list[str]:
    """Complete a table's name."""
    found = [
        f"{prefix}{path.stem}"
        for prefix, folder in (("", "refit"), ("published/", "published"), ("best/", "best"))
        for path in sorted(_TABLES.glob(f"*/{folder}/*.json"), key=lambda path: path.name)
    ]
    return [name for name in found if name.startswith(incomplete)]


def complete_shader(incomplete: str) -> list[str]:
    """Complete the name of a table, a closed form, or another function that is exported."""
    others = [name for name in (*EXACT, *FUNCTIONS) if name.startswith(incomplete)]
    return [*complete_table(incomplete), *others]


def complete_language(incomplete: str) -> list[str]:
    """Complete the key of a language."""
    from programs.languages import LANGUAGES

    return [key for key in LANGUAGES if key.startswith(incomplete)]
