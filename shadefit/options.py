"""Options that several commands share, and what their values may be."""

import math
import re
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from integrals import Axis

_ANGLE = re.compile(r"^\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(deg|rad|°)?\s*$")


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


def checked(axis: "Axis", value: float) -> float:
    """Return an option's value; raise ValueError, by the option's name, outside the axis's domain.

    Of an angle the domain is given as degrees are written, too: who left 'deg' out sees it.
    """
    try:
        return axis.check(value)
    except ValueError as error:
        degrees = ""
        if axis.unit == "rad":
            low, high = (f"{math.degrees(end):g}deg" for end in (axis.lower, axis.upper))
            degrees = f"; in degrees, {low} to {high}"
        flag = f"--{axis.name.replace('_', '-')}"
        raise ValueError(f"{flag}{str(error).removeprefix(axis.name)}{degrees}") from None


Json = Annotated[bool, typer.Option("--json", help="Print one JSON object instead of a table.")]
