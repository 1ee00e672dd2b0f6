"""Numbers as text, rounded to the safe side."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from programs.rounded_text import rounded_down, rounded_up


@pytest.mark.parametrize(
    ("value", "digits", "down", "up"),
    [
        (0.13323, 2, "0.13", "0.14"),
        (0.7, 3, "0.7", "0.7"),
        (0.9999, 2, "0.99", "1"),
        (8.24e-9, 2, "8.2e-09", "8.3e-09"),
        (0.0, 3, "0", "0"),
        (1234.5, 3, "1.23e+03", "1.24e+03"),
    ],
)
def test_a_number_is_rounded_to_the_safe_side(value, digits, down, up):
    assert (rounded_down(value, digits), rounded_up(value, digits)) == (down, up)


@given(st.floats(1e-300, 1e300), st.integers(1, 6))
def test_the_two_texts_enclose_the_number_tightly(value, digits):
    down, up = float(rounded_down(value, digits)), float(rounded_up(value, digits))
    assert down <= value <= up
    assert up - down <= value * 10.0 ** (1 - digits) * (1 + 1e-9)
