"""Families of forms: functions that make the forms of one kind, and what their arguments may be.

A form of a family is told by the family's name and the form's `shape`, which holds the arguments;
both are plain JSON values.
"""

import reprlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from fitting.form import Form

MAX_EXPONENT = 7
MAX_MONOMIALS = 36


@dataclass(frozen=True)
class Family:
    """A function that makes forms, and what each of its arguments may be.

    An argument's entry is a tuple or range of its values, 'fraction' for a number in (0, 1), or
    'exponents' for a list of pairs of whole numbers, empty only if it is 'exponents or none'.
    """

    make: Callable[..., Form]
    arguments: dict[str, Any]

    def form(self, name: str, shape: dict[str, Any]) -> Form:
        """Return the form with a shape; raises ValueError for one that is not allowed."""
        if set(shape) != set(self.arguments):
            # What a file holds may be long: it is shown in part.
            given = reprlib.repr(sorted(shape))
            raise ValueError(f"shape of {name!r} has {given}: allowed are {list(self.arguments)}")
        return self.make(
            **{key: _checked(key, shape[key], allowed) for key, allowed in self.arguments.items()}
        )


def _checked(name: str, value: Any, allowed: Any) -> Any:
    if allowed == "fraction":
        if isinstance(value, float) and 0 < value < 1:
            return value
        raise ValueError(f"{name} = {reprlib.repr(value)}: allowed is a number between 0 and 1")
    if allowed in ("exponents", "exponents or none"):
        return _exponents(name, value, some=allowed == "exponents")
    if value in allowed and type(value) is type(allowed[0]):
        return value
    allowed = ", ".join(map(str, allowed))
    raise ValueError(f"{name} = {reprlib.repr(value)}: allowed are {allowed}")


def _exponents(name: str, value: Any, some: bool) -> tuple[tuple[int, int], ...]:
    """Check pairs of exponents; where none is needed, the constant is there already."""
    given = value if isinstance(value, list | tuple) else [value]
    pairs = [tuple(pair) if isinstance(pair, list | tuple) else () for pair in given]
    good = all(
        len(pair) == 2 and all(type(k) is int and 0 <= k <= MAX_EXPONENT for k in pair)
        for pair in pairs
    )
    if (
        not good
        or len(set(pairs)) < len(pairs)
        or not some <= len(pairs) <= MAX_MONOMIALS
        or (not some and (0, 0) in pairs)
    ):
        raise ValueError(
            f"{name} = {reprlib.repr(value)}: allowed are up to {MAX_MONOMIALS} different pairs "
            f"of whole numbers from 0 to {MAX_EXPONENT}"
        )
    return tuple((i, j) for i, j in pairs)
