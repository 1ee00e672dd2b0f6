"""The difference of values from expected ones, and how it is written."""

from dataclasses import dataclass

import numpy as np

from programs.rounded_text import rounded_up


@dataclass(frozen=True)
class Difference:
    """The largest and the rms difference of the finite values from the expected values.

    `not_finite` is the number of other values: near a pole, a denominator may be rounded to zero.
    """

    largest: float
    rms: float
    not_finite: int = 0

    def within(self, other: "Difference") -> bool:
        """Return whether no field of this difference is larger than that of the other."""
        return (
            self.largest <= other.largest
            and self.rms <= other.rms
            and self.not_finite <= other.not_finite
        )


def difference(
    values: np.ndarray, expected: np.ndarray, units: np.ndarray | None = None
) -> Difference:
    """Return the difference of values (n,) from expected ones, which are finite.

    It is divided by `units` (n,), if given.
    """
    finite = np.isfinite(values)
    apart = np.abs(values[finite] - expected[finite])
    apart = apart if units is None else apart / units[finite]
    count = max(len(apart), 1)
    return Difference(
        float(np.max(apart, initial=0.0)),
        float(np.sqrt(np.sum(apart**2) / count)),
        int(np.sum(~finite)),
    )


def text_of(apart: Difference) -> str:
    """Write a difference with two digits, rounded up.

    More digits would change with the compiler's version.
    """
    others = f", {apart.not_finite} values not finite" if apart.not_finite else ""
    return f"rms {two_digits(apart.rms)}, largest {two_digits(apart.largest)}{others}"


def two_digits(value: float) -> str:
    """Write a number that is not negative with two digits, rounded up: 0.13323 as '1.4e-01'."""
    return f"{float(rounded_up(value, 2)):.1e}"
