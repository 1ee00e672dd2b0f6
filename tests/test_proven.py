import re

import pytest

from coefficients.catalogue import load, names
from coefficients.proven import proven

PROVEN = [name for name in names() if load(name).certificates is not None]
NUMBER = r"[-+.\de]+"


@pytest.mark.parametrize("name", PROVEN)
def test_no_number_says_more_than_is_proven(name):
    certificates, text = load(name).certificates, "; ".join(proven(load(name)))
    bound = re.search(rf"denominators ≥ ({NUMBER})", text)
    assert (bound is None) == (certificates.denominator_bound is None)
    if bound is not None:
        assert 0.99 * certificates.denominator_bound < float(bound[1])
        assert float(bound[1]) <= certificates.denominator_bound
    values = re.search(rf"values in \[({NUMBER}), ({NUMBER})\]", text)
    assert (values is None) == (certificates.range is None)
    if values is not None:
        low, high = (float(each) for each in values.groups())
        assert low <= certificates.range[0] < low + 1e-4
        # What is above one is so by the proof's own rounding.
        assert high >= min(certificates.range[1], 1) > high - 2e-4
    least = re.search(rf"error below ({NUMBER})", text)
    assert (least is None) == (certificates.least_error is None)
    if least is not None:
        assert 0.99 * certificates.least_error < float(least[1]) <= certificates.least_error


def test_one_sided_tables_say_so():
    assert "none above the exact value" in proven(load("velvet"))
    assert not any("above" in each for each in proven(load("best/r-25")))


def test_nothing_is_proven_of_what_was_published():
    assert proven(load("published/g")) == []
