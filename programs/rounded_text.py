"""Numbers as text with a few digits, rounded to the safe side. This module needs no JAX."""

from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal


def rounded_down(value: float, digits: int) -> str:
    """Write a number that is not negative with some digits, rounded down."""
    return _rounded(value, digits, ROUND_FLOOR)


def rounded_up(value: float, digits: int) -> str:
    """Write a number that is not negative with some digits, rounded up."""
    return _rounded(value, digits, ROUND_CEILING)


def _rounded(value: float, digits: int, rounding: str) -> str:
    # A number with few digits, such as 0.7, is not exactly the float that stands for it.
    exact = Decimal(repr(float(value)))
    return f"{float(Context(prec=digits, rounding=rounding).create_decimal(exact)):.{digits}g}"
