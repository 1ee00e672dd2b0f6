"""Options that several commands share, and how their values are read."""

import math
import re
import sys
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fitting import goal

if TYPE_CHECKING:
    from fitting.second_opinion import SecondOpinion as Opinion
    from integrals.reference import Axis

_ANGLE = re.compile(r"^\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(deg|rad|°)?\s*$")

# The smallest normal number of float64, 2^-1022
LEAST = sys.float_info.min

Json = Annotated[bool, typer.Option("--json", help="Print one JSON object instead of a table.")]

# search has its own defaults (linf, float32); refit takes those of each table.
Norm = Annotated[
    goal.Norm | None,
    typer.Option(
        help="l2 minimises squared errors, linf the largest error; "
        "by default refit does as the table did, fit takes l2, search linf."
    ),
]
Side = Annotated[
    goal.Side | None,
    typer.Option(help="With linf: allow no values above (or below) the exact ones."),
]
Rounding = Annotated[
    goal.Rounding | None,
    typer.Option(
        help="Precision to round coefficients to, in groups; the others are refitted after each."
    ),
]
Relative = Annotated[
    bool, typer.Option("--relative", help="Minimise relative errors instead of absolute ones.")
]
Bounded = Annotated[
    bool,
    typer.Option(
        "--bounded",
        help="With linf: keep all values within the codomain (a fraction: between 0 and 1), and "
        "prove it.",
    ),
]


SecondOpinion = Annotated[
    bool,
    typer.Option(
        "--second-opinion",
        help="Refit with another solver (jaxopt) from other starts, and say where it ends.",
    ),
]


def opinion_text(found: "Opinion | str") -> str:
    """Return what another solver found, as a sentence; a text says why there is none."""
    if isinstance(found, str):
        return f"second opinion: none: {found}"
    same = f"values differ by at most {found.values:.2g}, coefficients by {found.coefficients:.2g}"
    if found.agreed:
        return f"second opinion: the same, from {found.tried} other starts; {same} (relative)"
    word = "a better one" if found.better else "another one, which is not better"
    return (
        f"second opinion: {word}, of {found.tried} other starts: error {found.other_error:.4g} "
        f"instead of {found.error:.4g}; {same} (relative)"
    )


def goal_fields(norm, side, rounding, relative: bool, bounded: bool) -> dict[str, Any]:
    """Return the fields of a goal whose options were given."""
    given = {
        "norm": norm,
        "side": side,
        "rounding": rounding,
        "relative": relative or None,
        "bounded": bounded or None,
    }
    return {key: value for key, value in given.items() if value is not None}


def angle(text: str) -> float:
    """Read an angle such as '45deg', '0.8rad' or '0.8' (radians) as radians."""
    match = _ANGLE.match(text)
    if match is None:
        raise typer.BadParameter(
            f"{text!r} is no angle: allowed is a number with 'deg' or 'rad' behind it, as in 45deg"
        )
    number, unit = match.groups()
    # math.radians(90) equals math.pi / 2 exactly, so that 90deg is not outside a domain up to π/2.
    return math.radians(float(number)) if unit in ("deg", "°") else float(number)


def flag_of(name: str) -> str:
    """Return the option for an axis, such as '--theta-f' for theta_f."""
    return f"--{name.replace('_', '-')}"


def checked(axis: "Axis", value: float) -> float:
    """Return an option's value. Raise ValueError if it is outside the domain of the axis.

    The message names the option. For an angle it states the domain in degrees too, so that a user
    who forgot 'deg' sees the mistake. Compiled code takes a number below `LEAST` for 0, which may
    be outside the domain.
    """
    if 0 < value < LEAST and not axis.contains(0.0):
        raise ValueError(
            f"{flag_of(axis.name)} = {value:g} is so small that it counts as 0: allowed are "
            f"numbers from {LEAST:.4g}"
        )
    try:
        return axis.check(value)
    except ValueError as error:
        degrees = ""
        if axis.unit == "rad":
            low, high = (f"{math.degrees(end):g}deg" for end in (axis.lower, axis.upper))
            degrees = f"; in degrees, {low} to {high}"
        message = str(error).removeprefix(axis.name)
        raise ValueError(f"{flag_of(axis.name)}{message}{degrees}") from None
