"""Rational forms of several quantities with one denominator, which are fitted together.

The quantities are joined to one, which has a further axis: the number of the quantity. Its form is
the sum of the numerators, each times a weight that is 1 at its own number and 0 at the others, over
the denominator. It is a quotient of linear functions, and is fitted and proven as any other one.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import jax.numpy as jnp
import numpy as np

from fitting.fit import Fit, fit
from fitting.form import Form, Stage
from fitting.goal import Goal
from fitting.points.sample import sample_of
from fitting.shapes.monomial_sums import ONE, Exponents, nested_horner
from fitting.solvers.given import Given
from integrals.data import Data
from integrals.reference import Axis
from integrals.reference_of_source import make_reference

_NUMBER = "number__"


@dataclass(frozen=True)
class Monomials:
    """The exponents of the monomials of rational forms: each numerator's, and the denominator's.

    The constant is one of the denominator's; its coefficient is 1.
    """

    above: tuple[Exponents, ...]
    below: tuple[Exponents, ...]


def fit_shared(forms: Sequence[Form], monomials: Monomials, goal: Goal) -> list[Fit]:
    """Fit rational forms of several quantities, which have one denominator.

    `forms` are rational forms of the same axes, with these `monomials` and without factors, each of
    its own quantity. The sum of the squared errors of all, or the largest error of all, is
    minimised at the points where each form is fitted; errors have the weights of each quantity.
    Returns a fit for each form, whose last coefficients are equal. Raises ValueError for less than
    two forms, for other axes, and for a bounded goal.
    """
    if len(forms) < 2:
        raise ValueError(f"{len(forms)} forms: a denominator is shared by at least 2")
    if goal.bounded:
        raise ValueError("bounded = True: allowed is False for a shared denominator")
    for form in forms[1:]:
        if form.axes != forms[0].axes:
            raise ValueError(
                f"{form.reference.name}: allowed are the axes and domains of the others"
            )
    together = _together(forms, monomials, goal)
    # The weights of relative errors are in the data of the whole already.
    whole = fit(together, replace(goal, relative=False))
    found, count = np.asarray(whole.fitted.constants).ravel(), len(monomials.above)
    shared = found[len(forms) * count :]
    words = f"{whole.solver}; all {len(forms)} with one denominator"
    return [
        fit(
            form,
            goal,
            exchange=Given(
                np.concatenate([found[k * count : (k + 1) * count], shared]),
                words,
                bool(whole.converged),
            ),
        )
        for k, form in enumerate(forms)
    ]


def _together(forms: Sequence[Form], monomials: Monomials, goal: Goal) -> Form:
    """Return the form of all quantities, whose last axis is the number of the quantity."""
    samples = [
        sample_of(form, goal, next(iter(form.reference.sampling.measures))) for form in forms
    ]
    points = [
        np.column_stack([each.points, np.full(len(each.points), float(k))])
        for k, each in enumerate(samples)
    ]
    values = np.concatenate([each.exact for each in samples])
    data = Data(
        np.concatenate(points),
        values,
        1 / np.concatenate([each.scale for each in samples]),
        np.zeros(len(values), bool),
        "the quantities together",
        "",
    )
    name = "-".join(form.reference.name for form in forms)
    axes = (*forms[0].axes, Axis(_NUMBER, 0.0, float(len(forms) - 1)))
    reference = make_reference(data, name=name, axes=axes)
    above, below = monomials.above, monomials.below
    free = [each for each in below if any(each)]
    count = len(above)

    def value(c, *point) -> Any:
        *z, number = point
        # N/D, with a numerator that is that of quantity k where the number is k
        total = jnp.zeros(())
        for k in range(len(forms)):
            own = dict(zip(above, c[k * count : (k + 1) * count], strict=True))
            total = total + jnp.maximum(1 - jnp.abs(number - k), 0.0) * nested_horner(own, z)
        shared = dict(zip(free, c[len(forms) * count :], strict=True))
        return total / nested_horner({each: shared.get(each, ONE) for each in below}, z)

    names = [f"a{k}_{n}" for k in range(len(forms)) for n in range(count)]
    names += [f"b{n}" for n in range(len(free))]
    return Form("shared", "N/D", reference, axes, names, (Stage(value),))
