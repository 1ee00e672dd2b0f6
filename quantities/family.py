"""Families of forms: functions that make similar forms, and what their arguments may be.

A table identifies such a form by the family's name and the form's `shape`. The shape holds the
arguments of the family's function as plain JSON values.
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
    """A function `make` that makes forms, and the values that each of its `arguments` may have.

    The entry of an argument is one of these: a tuple or a range with all allowed values; 'fraction'
    for a number in (0, 1); 'exponents' for a list of different pairs of whole numbers;
    'exponents or none' for such a list that may be empty, and does not contain (0, 0).
    """

    make: Callable[..., Form]
    arguments: dict[str, Any]

    def form(self, name: str, shape: dict[str, Any]) -> Form:
        """Return the form of a shape. Raises ValueError for a shape that is not allowed."""
        if set(shape) != set(self.arguments):
            # The shape may come from a file and be long: only a part is shown.
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
    """Return pairs of exponents as tuples. Raises ValueError for pairs that are not allowed.

    If `some` is false, there may be none, and (0, 0) is not allowed, because the polynomial has a
    constant already.
    """
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
