"""Checks of the names that a user gave, before a command imports what it runs.

A misspelt name is refused at once: none of these checks waits for JAX.
"""

import sys
from collections.abc import Sequence
from importlib.metadata import entry_points

from shadefit.completion import QUANTITIES


def require_tables(names: Sequence[str]) -> None:
    """Raise ValueError for the first name that cannot be a table, a closed form, or a file.

    Nothing is refused here if there may be a user's quantities.
    """
    if _is_extended():
        return
    from coefficients.packaged import CURVATURE, EXACT, SAMPLER, is_file, is_packaged, unknown

    for name in names:
        listed = is_packaged(name) or is_file(name)
        if not (listed or name.startswith((f"{EXACT}/", f"{SAMPLER}/", f"{CURVATURE}/"))):
            raise unknown(name, QUANTITIES)


def require_quantities(names: Sequence[str], refusal: str, others: Sequence[str] = ()) -> None:
    """Raise ValueError for the first name that is neither a built-in quantity nor one of `others`.

    `refusal` begins the message: 'nothing is called'. Nothing is refused here if there may be a
    user's quantities.
    """
    if _is_extended():
        return
    allowed = (*QUANTITIES, *others)
    for name in names:
        if name not in allowed:
            raise ValueError(f"{refusal} {name!r}: allowed are {', '.join(allowed)}")


def _is_extended() -> bool:
    """Return whether there may be other quantities, of a user's file or an installed package."""
    return "quantities.registry" in sys.modules or bool(entry_points(group="shadefit.problems"))
