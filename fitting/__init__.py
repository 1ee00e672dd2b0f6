"""Compact forms that approximate exact values, and how their coefficients are found and checked.

A `Form` is a function whose coefficients have no values yet. `fitting.fit.fit` finds the values for
any form and returns a `Fit`: the coefficients, the errors at points that the fit did not use, and
proofs for the whole domain. Folders: `shapes/` (formulas that several forms share), `points/`
(where forms are fitted and judged), `solvers/` and `proofs/`.

The names below are imported when they are first used, so that a program that needs only
`fitting.goal` does not wait for the import of JAX.
"""

from typing import TYPE_CHECKING

from programs.public_names import import_when_used

if TYPE_CHECKING:
    from fitting.errors import Errors as Errors
    from fitting.errors import form_values as form_values
    from fitting.errors import judge as judge
    from fitting.fit import Fit as Fit
    from fitting.form import FittedForm as FittedForm
    from fitting.form import Form as Form
    from fitting.form import Proofs as Proofs
    from fitting.form import Stage as Stage
    from fitting.form import plain_form as plain_form
    from fitting.goal import Goal as Goal
    from fitting.points.domain import Domain as Domain
    from fitting.points.domain import common_domain as common_domain

__getattr__, __dir__, __all__ = import_when_used(
    __name__,
    {
        "fitting.errors": ("Errors", "form_values", "judge"),
        "fitting.fit": ("Fit",),
        "fitting.form": ("FittedForm", "Form", "Proofs", "Stage", "plain_form"),
        "fitting.goal": ("Goal",),
        "fitting.points.domain": ("Domain", "common_domain"),
    },
)
