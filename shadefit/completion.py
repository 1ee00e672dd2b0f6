"""What a shell may complete: names of quantities, tables, shaders and languages.

The names are read from the tables' files and from the table below, and tests hold that table to the
registry: the registry imports JAX, for which every press of the tab key would wait.
"""

from pathlib import Path

_TABLES = Path(__file__).parent.parent / "coefficients" / "tables"
# The quantities in the order of the registry, and those of them that have an exported closed form.
QUANTITIES = ("ps", "g", "q", "r", "velvet")
EXACT = ("exact/ps", "exact/g", "exact/q", "exact/velvet")


def complete_quantity(incomplete: str) -> list[str]:
    """Complete what can be refitted."""
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
    """Complete what can be exported as code."""
    exact = [name for name in EXACT if name.startswith(incomplete)]
    return [*complete_table(incomplete), *exact]


def complete_language(incomplete: str) -> list[str]:
    """Complete a language."""
    from programs.languages import LANGUAGES

    return [key for key in LANGUAGES if key.startswith(incomplete)]
