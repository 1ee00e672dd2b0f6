"""What is proven of a table on its whole domain, in words."""

import math

from coefficients.table import Table

_DIGITS = 1e4


def proven(table: Table) -> list[str]:
    """Say what a table's certificates prove, a phrase each, numbers rounded to the safe side."""
    certificates = table.certificates
    if certificates is None:
        return []
    bound, values = certificates.denominator_bound, certificates.range
    found = ["no denominator" if bound is None else f"denominators ≥ {_below(bound, 3)}"]
    if values is not None:
        low = math.floor(values[0] * _DIGITS) / _DIGITS
        high = min(math.ceil(values[1] * _DIGITS) / _DIGITS, 1.0)
        found.append(f"values in [{low:g}, {high:g}]")
    if (certificates.conservative_bound or 0) > 0:
        found.append("none above the exact value")
    if certificates.least_error is not None:
        least = _below(certificates.least_error, 3)
        found.append(f"no coefficients have a largest error below {least}")
    return found


def _below(value: float, digits: int) -> str:
    """Write a positive number with some digits, rounded down."""
    unit = 10.0 ** (math.floor(math.log10(value)) + 1 - digits)
    return f"{math.floor(value / unit) * unit:.{digits}g}"
