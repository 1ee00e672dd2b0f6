"""A search among sets of monomials: one is added at a time, the one that lowers the error most."""

from collections.abc import Iterator

import numpy as np

from fitting.families.r import VARIABLES, Exponents, monomial_r
from fitting.form import Form
from fitting.points.sample import Sample, sample_of
from fitting.solvers.minimax import linear_parts

# Monomials zⁱyʲ that the numerator and the denominator choose from, and how many they may have.
NUMERATOR = tuple((i, j) for i in range(4) for j in range(4))
DENOMINATOR = tuple((i, j) for i in range(3) for j in range(3) if i + j)
MOST = 20
# Iterations of the linear problem that judges a set.
LINEARISED = 3


def grown_r(least_alpha: float) -> Iterator[type[Form]]:
    """Give forms of R, in each of the variables, from few monomials to MOST."""
    for variable in VARIABLES:
        numerator: Exponents = ((0, 0), (0, 1))
        denominator: Exponents = ((1, 0),)
        sums = _Sums(variable, least_alpha)
        while len(numerator) + len(denominator) <= MOST:
            yield monomial_r(
                variable=variable,
                numerator=numerator,
                denominator=denominator,
                least_alpha=least_alpha,
            )
            choices: list[tuple[Exponents, Exponents]] = [
                *(((*numerator, new), denominator) for new in NUMERATOR if new not in numerator),
                *(
                    (numerator, (*denominator, new))
                    for new in DENOMINATOR
                    if new not in denominator
                ),
            ]
            numerator, denominator = min(choices, key=lambda choice: sums.error(*choice))
            numerator, denominator = tuple(sorted(numerator)), tuple(sorted(denominator))


class _Sums:
    """The columns of every monomial at the sample, so that a set is judged by a small problem."""

    def __init__(self, variable: str, least_alpha: float):
        """Evaluate every monomial once."""
        whole = monomial_r(
            variable=variable,
            numerator=NUMERATOR,
            denominator=DENOMINATOR,
            least_alpha=least_alpha,
        )
        self.sample: Sample = sample_of(whole)
        parts = linear_parts(whole, self.sample.points)
        assert parts is not None
        self.a0, self.a, self.b0, self.b = parts

    def error(self, numerator: Exponents, denominator: Exponents) -> float:
        """Give the rms error of the set's last linear problem; ∞ where it has a pole."""
        columns = [NUMERATOR.index(each) for each in numerator]
        columns += [len(NUMERATOR) + DENOMINATOR.index(each) for each in denominator]
        a, b, exact = self.a[:, columns], self.b[:, columns], self.sample.exact
        below, rms = self.b0, np.inf
        for _ in range(LINEARISED):
            matrix, values = a - exact[:, None] * b, exact * self.b0 - self.a0
            z = np.linalg.lstsq(matrix / below[:, None], values / below, rcond=None)[0]
            below = self.b0 + b @ z
            if below.min() <= 0:
                return np.inf
            rms = float(np.sqrt(np.mean(((self.a0 + a @ z) / below - exact) ** 2)))
        return rms
