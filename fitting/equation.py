"""The equations of forms, as text for people, and the small grammar that they keep to.

An equation is a list of statements, separated by semicolons. A statement gives a name to the value
of an expression, as in 'y = cos(θf)²', or defines a function of one number, as in
'u(i) = C[i] + C[i+1]·y'. The last statement gives the form's value.

An expression has numbers, names, parentheses, +, −, · and /. A superscript is a power, and √ is
the root of the name, number, call or parenthesis after it. Functions are written with parentheses:
cos(x), max(x, y). Names are those of earlier statements, the symbols of the arguments, and the
coefficients. These have their own names (see `coefficient_symbols`), or are called C[0], C[1], …
"""

import re
from collections.abc import Mapping, Sequence

import numpy as np

# The longest text that a table may have
_LONGEST = 2000
# A name: letters, Greek ones too, digits and underscores, but no superscripts
_NAME = r"[^\W\d⁰¹²³⁴⁵⁶⁷⁸⁹][^\W⁰¹²³⁴⁵⁶⁷⁸⁹]*"


def coefficient_symbols(names: Sequence) -> list[str]:
    """Return what the equation calls the coefficients, whose (nested) names are given, in order.

    'c0: d' is called c0. If one name does not begin with such a word, or two words are the same,
    the coefficients are called C[0], C[1], … instead.
    """
    flat = [str(each) for each in np.ravel(np.array(names, dtype=object))]
    words = [each.partition(":")[0].strip() for each in flat]
    if all(re.fullmatch(_NAME, word) for word in words) and len(set(words)) == len(words):
        return words
    return [f"C[{k}]" for k in range(len(flat))]


def equation_of(symbol: str, text: str, definitions: Sequence[str] = ()) -> str:
    """Return an equation: the definitions, then what the form's value `symbol` is.

    An equation that is too long for a table ends in '…'.
    """
    equation = "; ".join([*definitions, f"{symbol} = {text}"])
    return equation if len(equation) <= _LONGEST else f"{equation[: _LONGEST - 2]} …"


def free_variable(taken: Sequence[str]) -> str:
    """Return a name for the argument of a function that an equation defines."""
    return next(each for each in "xvpqr" if each not in taken)


def with_names(equation: str, names: Mapping[str, str], first: Sequence[str] = ()) -> str:
    """Return an equation with other names in the place of some.

    `names` maps the old to the new ones. `first` has the values of the first statements, in order:
    'c = cos(θu)' becomes 'c = NdotU'.
    """
    statements = equation.split("; ")
    for k, value in enumerate(first[: len(statements)]):
        left, equals, _ = statements[k].partition(" = ")
        statements[k] = f"{left}{equals}{value}" if equals else statements[k]
    text = "; ".join(statements)
    return re.sub(_NAME, lambda found: names.get(found[0], found[0]), text)
