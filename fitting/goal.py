"""The goal of a fit: what it minimises, its constraints, and the words that name them."""

from dataclasses import dataclass
from typing import Literal

Norm = Literal["l2", "linf"]
Side = Literal["both", "below", "above"]
Rounding = Literal["none", "float32", "float16"]


@dataclass(frozen=True)
class Goal:
    """What a fit minimises, and its constraints.

    * `norm`: 'l2' minimises the sum of squared errors, 'linf' the largest error.
    * `relative`: errors are divided by the exact value.
    * `side`: 'below' allows no value above the exact one, for a quantity that must not create
      energy; 'above' allows none below it. Both need 'linf'.
    * `rounding`: the precision that the coefficients are rounded to.
    * `bounded`: all values must be in the codomain of the quantity, [0, 1] for a fraction, and
      proven to be. It needs 'linf'.
    """

    norm: Norm = "l2"
    relative: bool = False
    side: Side = "both"
    rounding: Rounding = "none"
    bounded: bool = False

    def __post_init__(self) -> None:
        """Raise ValueError for a `side` or `bounded` with least squares."""
        if self.side != "both" and self.norm != "linf":
            raise ValueError(f"side = {self.side!r} with norm = 'l2': allowed with norm = 'linf'")
        if self.bounded and self.norm != "linf":
            raise ValueError("bounded = True with norm = 'l2': allowed with norm = 'linf'")


LEAST_SQUARES = Goal()
