"""Quantities that are fitted together by rational forms with one denominator."""

import shlex
from collections.abc import Sequence

import jax

from coefficients.record import table_of
from fitting.goal import Goal, Norm, Rounding
from fitting.shapes.monomial_sums import checked_exponents
from fitting.shared_denominator import Monomials, fit_shared
from shadefit.declaration import Problem
from shadefit.result import Result


def fit_with_shared_denominator(
    problems: Sequence[Problem],
    numerator: Sequence,
    denominator: Sequence,
    *,
    name: str = "shared",
    norm: Norm = "l2",
    relative: bool = False,
    rounding: Rounding = "none",
    command: str | None = None,
) -> list[Result]:
    """Fit quantities of the same axes by rational forms with one denominator.

    `numerator` and `denominator` are exponents of monomials, see `powers`; all numerators have the
    same ones. `norm`, `relative` and `rounding` are as for `Problem.fit`; the errors of all
    quantities are added up, or compared, so quantities of different size need `relative` or
    standard deviations. `command` is what made the fit, for the tables. Returns a result for each
    quantity. `shadefit export` with `--together` writes one function, which computes the
    denominator once. Raises ValueError for a denominator without a constant, for less than two
    quantities, for other axes, and for a fit that is refused.
    """
    if len(problems) < 2:
        raise ValueError(f"{len(problems)} quantities: a denominator is shared by at least 2")
    symbols = [axis.symbol for axis in problems[0].axes]
    above = checked_exponents(numerator, symbols, f"{name}: numerator")
    below = checked_exponents(denominator, symbols, f"{name}: denominator")
    if not any(not any(each) for each in below):
        raise ValueError(f"{name}: the denominator has no constant: allowed is one that has")
    goal = Goal(norm=norm, relative=relative, rounding=rounding)
    own = command or f"fit_with_shared_denominator({shlex.join(p.name for p in problems)})"
    with jax.enable_x64(True):
        forms = [each.rational(above, below, name=name) for each in problems]
        fits = fit_shared(forms, Monomials(above, below), goal)
        tables = [
            table_of(made, own, owner=owner) for made, owner in zip(fits, problems, strict=True)
        ]
    # The points of all quantities determine the denominator: a table does not know how well.
    return [
        Result(owner, made, table.model_copy(update={"uncertainty": None}))
        for owner, made, table in zip(problems, fits, tables, strict=True)
    ]
