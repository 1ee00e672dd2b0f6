"""A greedy choice of a quotient's monomials: each step adds the one that lowers the error most."""

from collections.abc import Iterator

import numpy as np

from fitting.form import Form
from fitting.goal import Goal
from fitting.linearity import linear_parts
from fitting.points.sample import Sample, sample_of
from fitting.shapes.monomials import Exponents

# The number of monomials of the last set.
MOST = 20
# A set is judged by a linear fit, which divides the errors by the denominator of the fit before.
# This is the number of such fits.
LINEARISED = 3

# The exponents of the monomials of a numerator and of a denominator.
Choice = tuple[Exponents, Exponents]


def greedy_sets(
    whole: Form, numerator: Exponents, denominator: Exponents, start: Choice, most: int = MOST
) -> Iterator[Choice]:
    """Yield sets of monomials for a numerator and a denominator, each with one more than before.

    The first set is `start`; the last one has `most` monomials. They are chosen from `numerator`
    and `denominator`. `whole` is the quotient of all of these; its coefficients are those of the
    numerator, then those of the denominator.
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
    """The values of all monomials at the points of the fit.

    They are computed once. A set is then judged by a linear fit with the columns of its monomials.
    """

    def __init__(self, whole: Form, numerator: Exponents, denominator: Exponents):
        """Evaluate every monomial once."""
        self.numerator, self.denominator = numerator, denominator
        # Points on faces count too: the largest error of a search is often there.
        self.sample: Sample = sample_of(whole, Goal("linf"))
        parts = linear_parts(whole, self.sample.points)
        assert parts is not None
        self.parts = parts

    def error(self, above: Exponents, below: Exponents) -> float:
        """Return the rms error of a set after its last linear fit; ∞ if a fit has a pole."""
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
