"""What a fit is to make small."""

from dataclasses import dataclass
from typing import Literal

from fitting.solvers.minimax import Side

Norm = Literal["l2", "linf"]
Rounding = Literal["none", "float32", "float16"]


@dataclass(frozen=True)
class Goal:
    """Least squares ('l2') or least largest error ('linf'), of the error or of the relative one.

    `side` 'below' allows no value above the exact one: energy is lost, not created; it is for
    'linf'. `rounding` is the precision that the coefficients are given in. A `bounded` fit has all
    values between 0 and 1, and proven to be; it is for 'linf' too.
    """

    norm: Norm = "l2"
    relative: bool = False
    side: Side = "both"
    rounding: Rounding = "none"
    bounded: bool = False

    def __post_init__(self) -> None:
        """Raise ValueError for a side or bounds with least squares."""
        if self.side != "both" and self.norm != "linf":
            raise ValueError(f"side = {self.side!r} with norm = 'l2': allowed with norm = 'linf'")
        if self.bounded and self.norm != "linf":
            raise ValueError("bounded = True with norm = 'l2': allowed with norm = 'linf'")


LEAST_SQUARES = Goal()
