"""Equations as text: their grammar, their names, and those of the generic shapes."""

import jax.numpy as jnp
import numpy as np
import pytest

from fitting.equation import coefficient_symbols, with_names
from fitting.shapes import (
    chebyshev,
    exponentials,
    piecewise_linear,
    pole_sum,
    polynomial,
    powers,
    rational,
)
from tests.equation_reader import points_of, require_same, value_of
from tests.fitting.lines import LINE
from tests.fitting.toys import TOY

TWO = powers(2, 2, total=True)
SHAPES = {
    "a rational": rational(LINE, powers(2)[1:], powers(2), name="r", of=lambda eta: eta - 1),
    "a rational of two axes": rational(
        TOY, TWO, TWO, name="r", times=lambda x: x, plus=lambda y: 2 + jnp.sin(y) * jnp.sqrt(y + 2)
    ),
    "a rational of two variables": rational(
        TOY, TWO, [(0, 0), (1, 1)], name="r", of=lambda x, y: (x * x, jnp.exp(-y))
    ),
    "a polynomial": polynomial(TOY, 9, name="p"),
    "a sum of poles": pole_sum(LINE, 2, 1, name="p", of=lambda eta: 1 / eta),
    "a sum of exponentials": exponentials(LINE, 3, name="e", constant=True),
    "a monotone sum of exponentials": exponentials(LINE, 2, name="e", monotone=True),
    "a sum of exponentials with coefficients of another axis": exponentials(
        TOY, 2, name="e", constant=True, along="y", degree=2
    ),
    "pieces on a grid": piecewise_linear(TOY, (3, [-0.5, 0.5, 1.5]), name="p"),
    "Chebyshev polynomials": chebyshev(LINE, 5, name="c"),
    "Chebyshev polynomials of two axes": chebyshev(TOY, (2, 3), name="c"),
    "pieces of lines": piecewise_linear(LINE, 7, name="p"),
    "pieces between given knots": piecewise_linear(LINE, [1.1, 1.3, 2.7], name="p"),
}


@pytest.mark.parametrize("what", SHAPES)
def test_the_equation_of_a_shape_gives_its_values(what):
    form = SHAPES[what]
    coefficients = np.random.default_rng(7).uniform(0.1, 1.0, form.size)
    require_same(form, coefficients, points_of(form, 20))


def test_names_are_replaced_whole_and_at_once():
    text = "c = cos(θ); x = c·θ; y = x·xx"
    assert with_names(text, {"x": "xx", "θ": "x"}, ["NdotU"]) == "c = NdotU; xx = c·x; y = xx·xx"


@pytest.mark.parametrize(
    ("names", "symbols"),
    [
        (["c0: d", "c1: d²"], ["c0", "c1"]),
        (["t", "p β"], ["C[0]", "C[1]"]),
        (["u: 1", "u: y"], ["C[0]", "C[1]"]),
        ([["c0: t", "c0: p"], ["c1: t", "c1: p"]], ["C[0]", "C[1]", "C[2]", "C[3]"]),
        ([], []),
    ],
)
def test_coefficients_have_their_own_names_if_these_are_different_words(names, symbols):
    assert coefficient_symbols(names) == symbols


@pytest.mark.parametrize(
    "equation",
    [
        "y = x z",
        "y = 2·missing",
        "y = x; y = 2·x",
        "y = √x·(",
        "y = (x; z = y",
        "y = x·",
        "y = C[1]",
        "y = x(2)",
        "a polynomial of 1 terms",
    ],
)
def test_the_reader_refuses_what_is_no_equation(equation):
    with pytest.raises((ValueError, IndexError)):
        value_of(equation, {"x": 2.0}, [1.0])


def test_the_reader_knows_the_grammar():
    text = "s(i) = C[i]·x² − C[i+1]; t = −x²/4 + max(√(x), ln(exp(1)))·s(1)³; y = t − 2 − 1"
    assert value_of(text, {"x": 4.0}, [0.0, 0.5, 7.0]) == -4 + 2 * (0.5 * 16 - 7.0) ** 3 - 3
