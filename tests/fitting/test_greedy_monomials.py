"""The greedy choice of monomials."""

import itertools

import numpy as np
import pytest

from fitting import Goal
from fitting.fit import fit
from fitting.greedy_monomials import greedy_sets
from fitting.linearity import linear_parts
from fitting.points.sample import sample_of
from fitting.shapes.monomials import horner
from quantities.fuzz import r_forms
from tests.fitting.toys import toy_form

ABOVE = ((0, 0), (0, 1), (1, 0), (1, 1))
BELOW = ((1, 0), (0, 1))


def toy(numerator, denominator):
    """Return N(x, y)/D(x, y) with these monomials and the denominator's constant one."""
    split = len(numerator)

    def value(c, x, y):
        above = horner(dict(zip(numerator, c[:split], strict=True)), x, y)
        below = {(0, 0): 1.0, **dict(zip(denominator, c[split:], strict=True))}
        return above / horner(below, x, y)

    names = [f"N: {each}" for each in numerator] + [f"D: {each}" for each in denominator]
    return toy_form(value, names)


def sets(most: int):
    start = (((0, 0),), ((1, 0),))
    return list(greedy_sets(toy(ABOVE, BELOW), ABOVE, BELOW, start, most))


def linearised_rms(numerator, denominator) -> float:
    """Return the error that judges a set, of the form itself: see the module."""
    form = toy(numerator, denominator)
    sample = sample_of(form, Goal("linf"))
    parts = linear_parts(form, sample.points)
    below = parts.b0
    for _ in range(3):
        matrix = (parts.a - sample.exact[:, None] * parts.b) / below[:, None]
        z = np.linalg.lstsq(matrix, (sample.exact * parts.b0 - parts.a0) / below, rcond=None)[0]
        below = parts.b0 + parts.b @ z
        if below.min() <= 0:
            return np.inf
    return float(np.sqrt(np.mean(((parts.a0 + parts.a @ z) / below - sample.exact) ** 2)))


def test_every_set_has_one_monomial_more():
    found = sets(5)
    assert found[0] == (((0, 0),), ((1, 0),))
    assert [len(above) + len(below) for above, below in found] == [2, 3, 4, 5]
    for before, after in itertools.pairwise(found):
        assert set(before[0]) <= set(after[0]) and set(before[1]) <= set(after[1])
        assert list(after[0]) == sorted(after[0]) and list(after[1]) == sorted(after[1])


def test_the_monomial_that_lowers_the_error_most_is_added():
    for (above, below), chosen in itertools.pairwise(sets(5)):
        choices = [
            *((tuple(sorted((*above, new))), below) for new in ABOVE if new not in above),
            *((above, tuple(sorted((*below, new)))) for new in BELOW if new not in below),
        ]
        errors = {choice: linearised_rms(*choice) for choice in choices}
        assert errors[chosen] == pytest.approx(min(errors.values()), rel=1e-9)


@pytest.mark.slow
def test_sets_for_r_grow_and_lower_the_error():
    forms = list(itertools.islice(r_forms.candidates(0.15), 6))
    assert [form.size for form in forms] == list(range(forms[0].size, forms[0].size + 6))
    first, last = (fit(form, Goal()).off_grid.rms for form in (forms[0], forms[-1]))
    assert last < 0.1 * first
