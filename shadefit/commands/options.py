"""Options that several commands share, and how their values are read."""

import math
import re
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fitting import goal

if TYPE_CHECKING:
    from integrals.reference import Axis

_ANGLE = re.compile(r"^\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(deg|rad|°)?\s*$")

Json = Annotated[bool, typer.Option("--json", help="Print one JSON object instead of a table.")]

Norm = Annotated[
    goal.Norm | None,
    typer.Option(help="Least squares or least largest error; by default the table's own."),
]
Side = Annotated[
    goal.Side | None,
    typer.Option(help="With linf, values never above (or below) the exact ones."),
]
Rounding = Annotated[
    goal.Rounding | None,
    typer.Option(help="Precision that coefficients are rounded to, the others refitted in turn."),
]
Relative = Annotated[bool, typer.Option("--relative", help="Make relative errors small.")]
Bounded = Annotated[
    bool, typer.Option("--bounded", help="With linf, values between 0 and 1, and proven to be.")
]


def goal_fields(norm, side, rounding, relative: bool, bounded: bool) -> dict[str, Any]:
    """Return the fields of a goal that options were given for."""
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
    # 90deg is π/2 to the last bit, so that the ends of a domain can be named.
    return math.radians(float(number)) if unit in ("deg", "°") else float(number)


def flag_of(name: str) -> str:
    """Return the option that an axis is given by: '--theta-f' for theta_f."""
    return f"--{name.replace('_', '-')}"


def checked(axis: "Axis", value: float) -> float:
    """Return an option's value; raise ValueError, by the option's name, outside the axis's domain.

    The domain of an angle is told in degrees too, so that who left 'deg' out sees it.
    """
    try:
        return axis.check(value)
    except ValueError as error:
        degrees = ""
        if axis.unit == "rad":
            low, high = (f"{math.degrees(end):g}deg" for end in (axis.lower, axis.upper))
            degrees = f"; in degrees, {low} to {high}"
        message = str(error).removeprefix(axis.name)
        raise ValueError(f"{flag_of(axis.name)}{message}{degrees}") from None
