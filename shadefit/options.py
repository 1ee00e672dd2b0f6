"""Options that several commands share, and what their values may be."""

import math
import re
from typing import Annotated

import typer

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


Json = Annotated[bool, typer.Option("--json", help="Print one JSON object instead of a table.")]
