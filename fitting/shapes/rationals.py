"""Forms that are polynomials, or quotients of polynomials, in any set of monomials."""

from collections.abc import Callable, Sequence
from typing import Any

import jax.numpy as jnp

from fitting.equation import equation_of
from fitting.form import Form, Stage
from fitting.shapes.monomial_sums import (
    ONE,
    Exponents,
    checked_exponents,
    coefficient_name,
    free_letter,
    nested_horner,
    powers,
    sum_text,
)
from fitting.shapes.variables import Variables, scalar_of_axes, variables_of
from integrals.reference import Axis, Reference


def rational(
    reference: Reference,
    numerator: Sequence,
    denominator: Sequence,
    *,
    name: str,
    axes: tuple[Axis, ...] | None = None,
    of: Callable | None = None,
    times: Callable | None = None,
    plus: Callable | None = None,
    one: int | Exponents | None = None,
) -> Form:
    """Return the form plus + times · (Σ aᵢ zⁱ)/(Σ bⱼ zʲ), a quotient of sums of monomials.

    * `numerator`, `denominator`: the exponents of the monomials. They are whole numbers for one
      variable and tuples of them for several, see `powers`.
    * `of`: the variables z, as a function of axes by name that returns a scalar or a tuple. None:
      the axes. An even form in x has `of=lambda x: x * x`.
    * `times`, `plus`: functions of axes by name; None stands for 1 and 0. They give the form its
      value at a boundary: with `times=lambda x: x, plus=lambda: 1` it is 1 at x = 0.
    * `one`: the exponents of the denominator's monomial whose coefficient is 1. None: the constant
      one if there is one, else the first.

    The other coefficients are called a or b and the exponents: a0, b2, a10. Both sums are evaluated
    in nested Horner form. Raises ValueError for exponents that do not fit the variables, for `one`
    that is not in the denominator, and for a function with other arguments than axes.
    """
    axes = reference.axes if axes is None else axes
    variables = variables_of(of, axes)
    above = checked_exponents(numerator, variables.symbols, f"{name}: numerator")
    below = checked_exponents(denominator, variables.symbols, f"{name}: denominator")
    taken = [*variables.symbols, *(text for axis in axes for text in (axis.name, axis.symbol))]
    a = free_letter("a", taken)
    b = free_letter("b", [*taken, f"{a}0"])
    chosen = _one(name, below, one, variables)
    over = [coefficient_name(a, each) for each in above]
    under = {each: coefficient_name(b, each) for each in below if each != chosen}
    denominators = {each: under.get(each, ONE) for each in below}
    quotient = _quotient_text(dict(zip(above, over, strict=True)), denominators, variables.symbols)
    return _form(
        reference,
        axes,
        name,
        [*over, *under.values()],
        (above, below, chosen),
        variables,
        quotient,
        times,
        plus,
    )


def polynomial(
    reference: Reference,
    exponents: int | Sequence,
    *,
    name: str,
    axes: tuple[Axis, ...] | None = None,
    of: Callable | None = None,
    times: Callable | None = None,
    plus: Callable | None = None,
) -> Form:
    """Return the form plus + times · Σ cᵢ zⁱ, a sum of monomials.

    `exponents` are those of the monomials, or a number: all monomials up to this total degree. The
    other arguments and the errors are as for `rational`.
    """
    axes = reference.axes if axes is None else axes
    variables = variables_of(of, axes)
    if isinstance(exponents, int):
        exponents = powers(exponents, len(variables.symbols), total=True)
    terms = checked_exponents(exponents, variables.symbols, f"{name}: polynomial")
    taken = [*variables.symbols, *(text for axis in axes for text in (axis.name, axis.symbol))]
    letter = free_letter("c", taken)
    names = [coefficient_name(letter, each) for each in terms]
    text = sum_text(dict(zip(terms, names, strict=True)), variables.symbols)
    parts = (terms, (), None)
    return _form(reference, axes, name, names, parts, variables, text, times, plus)


def _one(
    name: str, below: tuple[Exponents, ...], one: int | Exponents | None, variables: Variables
) -> Exponents:
    constant = (0,) * len(variables.symbols)
    if one is None:
        return constant if constant in below else below[0]
    (found,) = checked_exponents([one], variables.symbols, f"{name}: one")
    if found not in below:
        raise ValueError(f"{name}: one = {one!r}: allowed are the exponents of the denominator")
    return found


def _quotient_text(above: dict, below: dict, symbols: Sequence[str]) -> str:
    over, under = sum_text(above, symbols), sum_text(below, symbols)
    if under == "1":
        return over
    over = f"({over})" if len(above) > 1 else over
    return f"{over}/({under})" if len(below) > 1 or " " in under else f"{over}/{under}"


def _form(
    reference: Reference,
    axes: tuple[Axis, ...],
    name: str,
    coefficients: list[str],
    parts: tuple[tuple[Exponents, ...], tuple[Exponents, ...], Exponents | None],
    variables: Variables,
    text: str,
    times: Callable | None,
    plus: Callable | None,
) -> Form:
    above, below, one = parts
    factor, offset = (None if f is None else scalar_of_axes(f, axes) for f in (times, plus))
    is_quotient = any(any(each) or each != one for each in below)

    def value(c, *point) -> Any:
        z = variables.at(*point)
        result = nested_horner({each: c[k] for k, each in enumerate(above)}, z)
        if factor is not None:
            result = factor[0](*point) * result
        if is_quotient:
            free = iter(range(len(above), len(coefficients)))
            terms = {each: ONE if each == one else c[next(free)] for each in below}
            result = result / nested_horner(terms, z)
        return jnp.asarray(result if offset is None else offset[0](*point) + result)

    if factor is not None:
        text = f"{_held(factor[1])}·{text if _is_closed(text) else f'({text})'}"
    if offset is not None:
        text = f"{offset[1]} + {text}"
    equation = equation_of(reference.symbol, text, variables.definitions)
    return Form(name, equation, reference, axes, coefficients, (Stage(value),))


def _held(text: str) -> str:
    """Write a factor: in parentheses if it is a sum."""
    return f"({text})" if " " in text and not _is_closed(text) else text


def _is_closed(text: str) -> bool:
    """Whether a text needs no parentheses as a factor: it has no sum outside of parentheses."""
    depth = 0
    for letter, after in zip(text, f"{text[1:]} ", strict=True):
        depth += {"(": 1, ")": -1}.get(letter, 0)
        if depth == 0 and letter in "+−" and after == " ":
            return False
    return True
