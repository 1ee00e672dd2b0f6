"""Families of forms that know their integral: each function gives the forms of one family.

A form is told by its family and its `shape`, the family's arguments; both are plain JSON values.
"""

import itertools
import reprlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from fitting.families.g import DECAYS, FACTORS, RATES, decay_g, tied_g
from fitting.families.ps import MAX_DEGREE, cubic_ps, one_root_ps, two_root_ps
from fitting.families.q import STRUCTURES, pole_q
from fitting.families.r import VARIABLES, monomial_r
from fitting.form import Form

MAX_EXPONENT = 7
MAX_MONOMIALS = 36


@dataclass(frozen=True)
class Family:
    """A function that makes forms, and what each of its arguments may be.

    An argument's entry is a tuple or range of its values, 'alpha' for a least α in (0, 1), or
    'exponents' for a list of pairs of whole numbers.
    """

    make: Callable[..., type[Form]]
    arguments: dict[str, Any]


FAMILIES = {
    "pole-q": Family(
        pole_q, {"structure": tuple(STRUCTURES), "terms": range(9), "poles": range(5)}
    ),
    "decay-g": Family(decay_g, {"decay": DECAYS, "rate": tuple(RATES), "factor": tuple(FACTORS)}),
    "tied-g": Family(tied_g, {"poles": range(2), "root": range(2)}),
    "monomial-r": Family(
        monomial_r,
        {
            "variable": tuple(VARIABLES),
            "numerator": "exponents",
            "denominator": "exponents",
            "least_alpha": "alpha",
        },
    ),
    "one-root-ps": Family(
        one_root_ps,
        {"skew": range(2), "degree": range(MAX_DEGREE + 1), "least_alpha": "alpha"},
    ),
    "two-root-ps": Family(
        two_root_ps,
        {"terms": range(3, 6), "degree": range(MAX_DEGREE + 1), "least_alpha": "alpha"},
    ),
    "cubic-ps": Family(
        cubic_ps,
        {"steps": range(5), "degree": range(-1, MAX_DEGREE + 1), "least_alpha": "alpha"},
    ),
}


def form_class(family: str, shape: dict[str, Any]) -> type[Form]:
    """Give the form of a family with a shape; raises ValueError for what is not allowed."""
    if family not in FAMILIES:
        raise ValueError(f"form {family!r} is not known: allowed are {', '.join(FAMILIES)}")
    arguments = FAMILIES[family].arguments
    if set(shape) != set(arguments):
        # What a file holds may be long: it is shown in part.
        given = reprlib.repr(sorted(shape))
        raise ValueError(f"shape of {family!r} has {given}: allowed are {list(arguments)}")
    checked = {name: _checked(name, shape[name], arguments[name]) for name in arguments}
    if family == "pole-q" and checked["terms"] + checked["poles"] == 0:
        raise ValueError("terms + poles = 0: at least one is needed")
    return FAMILIES[family].make(**checked)


def _checked(name: str, value: Any, allowed: Any) -> Any:
    if allowed == "alpha":
        if isinstance(value, float) and 0 < value < 1:
            return value
        raise ValueError(f"{name} = {reprlib.repr(value)}: allowed is a number between 0 and 1")
    if allowed == "exponents":
        return _exponents(name, value)
    if value in allowed and type(value) is type(allowed[0]):
        return value
    allowed = ", ".join(map(str, allowed))
    raise ValueError(f"{name} = {reprlib.repr(value)}: allowed are {allowed}")


def _exponents(name: str, value: Any) -> tuple[tuple[int, int], ...]:
    given = value if isinstance(value, list | tuple) else [value]
    pairs = [tuple(pair) if isinstance(pair, list | tuple) else () for pair in given]
    good = all(
        len(pair) == 2 and all(type(k) is int and 0 <= k <= MAX_EXPONENT for k in pair)
        for pair in pairs
    )
    needed = name == "numerator"
    if (
        not good
        or len(set(pairs)) < len(pairs)
        or not needed <= len(pairs) <= MAX_MONOMIALS
        or (not needed and (0, 0) in pairs)
    ):
        raise ValueError(
            f"{name} = {reprlib.repr(value)}: allowed are up to {MAX_MONOMIALS} different pairs "
            f"of whole numbers from 0 to {MAX_EXPONENT}"
        )
    return tuple(pairs)


def candidates(quantity: str, least_alpha: float = 0.15) -> Iterator[type[Form]]:
    """Give the forms of a quantity that a search tries, except for R, which grows its own."""
    if quantity == "q":
        for structure, terms, poles in itertools.product(STRUCTURES, range(5), range(3)):
            if terms + poles > (structure == "free") and not (structure == "log" and poles):
                yield pole_q(structure=structure, terms=terms, poles=poles)
    elif quantity == "g":
        for decay, rate, factor in itertools.product(DECAYS, RATES, FACTORS):
            yield decay_g(decay=decay, rate=rate, factor=factor)
        for poles, root in itertools.product(range(2), range(2)):
            yield tied_g(poles=poles, root=root)
    elif quantity == "ps":
        for skew, degree in itertools.product(range(2), (1, 2, 3)):
            yield one_root_ps(skew=skew, degree=degree, least_alpha=least_alpha)
        for terms, degree in itertools.product((3, 4, 5), (2, 3, 4)):
            yield two_root_ps(terms=terms, degree=degree, least_alpha=least_alpha)
        for steps in range(4):
            yield cubic_ps(steps=steps, degree=-1, least_alpha=least_alpha)
        for degree in (0, 2, 4):
            yield cubic_ps(steps=0, degree=degree, least_alpha=least_alpha)
