"""Numbers as text with a few digits, rounded to the safe side. This module needs no JAX."""

import math


def rounded_down(value: float, digits: int) -> str:
    """Write a number that is not negative with some digits, rounded down."""
    if value == 0:
        return "0"
    unit = 10.0 ** (math.floor(math.log10(value)) + 1 - digits)
    text = f"{math.floor(value / unit) * unit:.{digits}g}"
    return text if float(text) <= value else f"{(math.floor(value / unit) - 1) * unit:.{digits}g}"


def rounded_up(value: float, digits: int) -> str:
    """Write a number that is not negative with some digits, rounded up."""
    if value == 0:
        return "0"
    unit = 10.0 ** (math.floor(math.log10(value)) + 1 - digits)
    text = f"{math.ceil(value / unit) * unit:.{digits}g}"
    return text if float(text) >= value else f"{(math.ceil(value / unit) + 1) * unit:.{digits}g}"
