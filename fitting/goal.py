"""What a fit makes small, and the words for it."""

from dataclasses import dataclass
from typing import Literal, get_args

Norm = Literal["l2", "linf"]
Side = Literal["both", "below", "above"]
Rounding = Literal["none", "float32", "float16"]
NORMS: tuple[Norm, ...] = get_args(Norm)
SIDES: tuple[Side, ...] = get_args(Side)
ROUNDINGS: tuple[Rounding, ...] = get_args(Rounding)


@dataclass(frozen=True)
class Goal:
    """Least squares ('l2') or least largest error ('linf'), of the error or of the relative one.

    `side` 'below' allows no value above the exact one, so that energy is lost and not created; it
    needs 'linf'. `rounding` is the precision that the coefficients are kept in. All values of a
    `bounded` fit are between 0 and 1, and proven to be; it needs 'linf' too.
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
