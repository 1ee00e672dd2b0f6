"""A greedy choice of monomials: one is added at a time, the one that lowers the error most."""

from collections.abc import Iterator

import numpy as np

from fitting.form import Form
from fitting.linearity import linear_parts
from fitting.points.sample import Sample, sample_of
from fitting.shapes.monomials import Exponents

# How many monomials the last set has, and iterations of the linear problem that judges a set.
MOST = 20
LINEARISED = 3

Choice = tuple[Exponents, Exponents]


def greedy_sets(
    whole: Form, numerator: Exponents, denominator: Exponents, start: Choice, most: int = MOST
) -> Iterator[Choice]:
    """Yield sets of monomials for a numerator and a denominator, from `start` to `most` monomials.

    `whole` is the quotient of all monomials of `numerator` and `denominator`, whose coefficients
    are in that order.
    """
    above, below = start
    sums = _Columns(whole, numerator, denominator)
    while len(above) + len(below) <= most:
        yield above, below
        choices: list[Choice] = [
            *(((*above, new), below) for new in numerator if new not in above),
            *((above, (*below, new)) for new in denominator if new not in below),
        ]
        above, below = min(choices, key=lambda choice: sums.error(*choice))
        above, below = tuple(sorted(above)), tuple(sorted(below))


class _Columns:
    """The columns of every monomial at the sample, so that a set is judged by a small problem."""

    def __init__(self, whole: Form, numerator: Exponents, denominator: Exponents):
        """Evaluate every monomial once."""
        self.numerator, self.denominator = numerator, denominator
        self.sample: Sample = sample_of(whole)
        parts = linear_parts(whole, self.sample.points)
        assert parts is not None
        self.parts = parts

    def error(self, above: Exponents, below: Exponents) -> float:
        """Return the rms error of the set's last linear problem; ∞ where it has a pole."""
        parts, exact = self.parts, self.sample.exact
        columns = [self.numerator.index(each) for each in above]
        columns += [len(self.numerator) + self.denominator.index(each) for each in below]
        a, b = parts.a[:, columns], parts.b[:, columns]
        denominator, rms = parts.b0, np.inf
        for _ in range(LINEARISED):
            matrix, values = a - exact[:, None] * b, exact * parts.b0 - parts.a0
            z = np.linalg.lstsq(matrix / denominator[:, None], values / denominator, rcond=None)[0]
            denominator = parts.b0 + b @ z
            if denominator.min() <= 0:
                return np.inf
            rms = float(np.sqrt(np.mean(((parts.a0 + a @ z) / denominator - exact) ** 2)))
        return rms
