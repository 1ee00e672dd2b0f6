"""The options of a quantity's axes, which differ by quantity: `--alpha 0.35 --phi 90deg`."""

from typing import TYPE_CHECKING

import typer

from shadefit.commands.options import angle, checked, flag_of

if TYPE_CHECKING:
    from integrals.reference import Axis
    from quantities import Problem


def axis_values(owner: "Problem", given: list[str]) -> dict[str, float]:
    """Read the options for a quantity's axes, such as ['--alpha', '0.35', '--phi=90deg'].

    Returns the values by the names of the axes, in the order of the axes. Raises ValueError for an
    option that is missing or that the quantity does not have, and for a value outside the domain of
    its axis.
    """
    flags = {flag_of(name): axis for axis in owner.axes for name in (axis.name, axis.alias) if name}
    wanted = ", ".join(flag_of(axis.name) for axis in owner.axes)
    values: dict[str, float] = {}
    rest = list(given)
    while rest:
        flag, equals, text = rest.pop(0).partition("=")
        if flag not in flags:
            raise ValueError(f"{flag} is no argument of {owner.name}, which takes {wanted}")
        if not equals:
            if not rest:
                raise typer.BadParameter(f"Option '{flag}' requires an argument.")
            text = rest.pop(0)
        values[flags[flag].name] = _number(flag, flags[flag], text)
    for axis in owner.axes:
        if axis.name not in values:
            flag = flag_of(axis.name)
            raise ValueError(f"{flag} is missing of {owner.name}, which takes {wanted}")
    return {axis.name: checked(axis, values[axis.name]) for axis in owner.axes}


def _number(flag: str, axis: "Axis", text: str) -> float:
    if axis.unit == "rad":
        return angle(text)
    try:
        return float(text)
    except ValueError:
        message = f"Invalid value for '{flag}': {text!r} is not a valid float."
        raise ValueError(message) from None
