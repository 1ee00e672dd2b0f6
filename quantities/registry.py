"""The known quantities, by name. `register` adds a user's quantity while the program runs."""

from quantities.fuzz import PS, VELVET, G, Q, R
from quantities.problem import Problem

_PROBLEMS: dict[str, Problem] = {each.name: each for each in (PS, G, Q, R, VELVET)}


def problems() -> dict[str, Problem]:
    """Return all quantities by name, in the order in which they are listed."""
    return dict(_PROBLEMS)


def problem(name: str) -> Problem:
    """Return the quantity with a name. Raises ValueError if there is none."""
    if name not in _PROBLEMS:
        raise ValueError(f"no quantity is called {name!r}: allowed are {', '.join(_PROBLEMS)}")
    return _PROBLEMS[name]


def register(new: Problem) -> Problem:
    """Add a quantity and return it. Raises ValueError if another quantity has its name."""
    if new.name in _PROBLEMS and _PROBLEMS[new.name] is not new:
        raise ValueError(f"a quantity is called {new.name!r} already: allowed is another name")
    _PROBLEMS[new.name] = new
    return new


def unregister(name: str) -> None:
    """Remove the quantity with a name, if there is one."""
    _PROBLEMS.pop(name, None)
