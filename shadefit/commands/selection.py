"""What `shadefit refit` fits: the quantities, forms and best tables that a user named."""

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from coefficients.catalogue import Entry
    from fitting import Form
    from quantities import Problem

ALL = "all"


def selection(names: list[str]) -> "list[Problem | Entry]":
    """Return the quantities and best tables with these names.

    Quantities come first, in the order of the registry. 'all' stands for all of them; no name, for
    those of the user's problem files or, if there are none, for all.
    """
    from coefficients.catalogue import resolve
    from coefficients.packaged import names_of_best
    from quantities import problem
    from quantities.registry import installed, registered
    from quantities.registry import names as names_of_quantities

    for name in set(names) & set(installed()):
        problem(name)  # Loads it.
    every, best = names_of_quantities(), names_of_best()
    names = names or [owner.name for owner in registered().values() if not owner.topic]
    unknown = [name for name in names if name not in (*every, ALL, *best)]
    if unknown:
        allowed = ", ".join((*every, ALL, *best))
        raise ValueError(f"nothing is called {unknown[0]!r}: allowed are {allowed}")
    whole = not names or ALL in names
    # Only these are imported, which takes less time than all.
    owners = [problem(name) for name in every if whole or name in names]
    return [*owners, *(resolve(name) for name in best if name in names)]


def own_folder(name: str) -> Path:
    """Return the folder of a packaged table, relative to the working directory if it is inside."""
    from coefficients.catalogue import is_kept, path_of
    from coefficients.packaged import in_checkout

    if not is_kept(name):
        raise ValueError(f"{name} has no folder of its own: give one by --out")
    if not in_checkout():
        raise ValueError(f"{name} comes with an installed package: give a folder by --out")
    folder, here = path_of(name).parent, Path.cwd()
    return folder.relative_to(here) if folder.is_relative_to(here) else folder


def parts(each: "Problem | Entry", forms: list[str]) -> "list[tuple[Problem, Form] | Entry]":
    """Return what is fitted: a best table, or a quantity with each of its forms that are wanted."""
    from quantities import Problem

    if not isinstance(each, Problem):
        return [each]
    if not forms or each.topic:
        return [(each, each.default)]
    if ALL in forms:
        return [(each, form) for form in each.forms]
    return [(each, each.find_form(name)) for name in dict.fromkeys(forms)]


def table_name(each: "tuple[Problem, Form] | Entry") -> str:
    """Return the name of the table: that of the quantity for its first form."""
    if not isinstance(each, tuple):
        return each.name
    owner, form = each
    return owner.name if form is owner.default else f"{owner.name}-{form.name}"
