"""Completion in the shell: names of quantities, tables, closed forms and languages.

The names come from the names of the tables' files and from the lists below. They do not come
from the registry, because it imports JAX, and every press of the tab key would wait for that. Tests
compare the lists with the registry.
"""

from pathlib import Path

_TABLES = Path(__file__).parent.parent / "coefficients" / "tables"
_GGX = ("ggx-directional-albedo", "ggx-scale", "ggx-bias", "ggx-average-albedo")
# The quantities in the order of the registry, and the other code to export.
QUANTITIES = ("ps", "g", "q", "r", "velvet", *_GGX)
EXACT = ("exact/ps", "exact/g", "exact/q", "exact/velvet")
SAMPLERS = (
    "sampler/ggx-upper",
    "sampler/ggx-upper-pdf",
    "sampler/ggx-bounded-cap",
    "sampler/ggx-bounded-cap-pdf",
    "sampler/ggx-cap",
    "sampler/ggx-cap-pdf",
    "sampler/ggx-disk",
    "sampler/ggx-disk-pdf",
)
CURVATURES = (
    "curvature/from-light",
    "curvature/effective",
    "curvature/pack",
    "curvature/unpack",
)


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
    """Complete the name of a table or of other code: what can be exported."""
    others = [name for name in (*EXACT, *SAMPLERS, *CURVATURES) if name.startswith(incomplete)]
    return [*complete_table(incomplete), *others]


def complete_language(incomplete: str) -> list[str]:
    """Complete the key of a language."""
    from programs.languages import LANGUAGES

    return [key for key in LANGUAGES if key.startswith(incomplete)]
