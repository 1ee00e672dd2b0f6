"""The proof that a form has no pole and no NaN anywhere on its domain, between samples too."""

import numpy as np

from fitting.form import FittedForm, Form, traced
from integrals.reference import Axis, box_of
from programs.bounding.branch_and_bound import BranchAndBound
from programs.bounding.denominators import DenominatorBound, prove_no_pole


def proof_axes(form: Form) -> tuple[Axis, ...]:
    """Return the axes of the domain that proofs about a form are made on."""
    return form.axes if form.proofs.axes is None else form.proofs.axes


def certify_denominators(fitted: FittedForm, enough: float = np.inf) -> DenominatorBound:
    """Bound every divisor of a form from below by a positive number, on the form's whole domain.

    Radicands are also proven not to be negative, and arguments of logarithms to be positive. The
    bound of a divisor is not improved once it reaches `enough`. Raises ValueError for an operation
    that has no interval version.
    """
    form, axes, constants = fitted.form, proof_axes(fitted.form), fitted.constants
    value = form if form.proofs.value is None else form.proofs.value
    program = traced(fitted, lambda *point: value(constants, *point), axes)
    solver = BranchAndBound(first_split=form.proofs.first_split)
    return prove_no_pole(program, box_of(axes), enough, solver)
