"""What a shell may complete: names of quantities, tables, shaders and languages."""

from pathlib import Path

# These repeat what coefficients/catalogue.py and coefficients/shaders.py know, and tests hold them
# to it: those import JAX, for which every press of the tab key would wait.
_PUBLISHED = ("ps", "g", "q", "r")
_NAMES = (*_PUBLISHED, "velvet")
_EXACT = ("exact/ps",)


def complete_quantity(incomplete: str) -> list[str]:
    """Complete what can be refitted."""
    return [name for name in (*_NAMES, "all") if name.startswith(incomplete)]


def complete_table(incomplete: str) -> list[str]:
    """Complete a table's name."""
    best = (Path(__file__).parent.parent / "coefficients" / "best").glob("*.json")
    every = [*_NAMES, *(f"published/{name}" for name in _PUBLISHED)]
    every += sorted(f"best/{path.stem}" for path in best)
    return [name for name in every if name.startswith(incomplete)]


def complete_shader(incomplete: str) -> list[str]:
    """Complete what can be exported as code."""
    exact = [name for name in _EXACT if name.startswith(incomplete)]
    return [*complete_table(incomplete), *exact]


def complete_language(incomplete: str) -> list[str]:
    """Complete a language."""
    from programs.languages import TARGETS

    return [key for key in TARGETS if key.startswith(incomplete)]
