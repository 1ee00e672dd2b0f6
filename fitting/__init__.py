"""Compact forms of exact values: fitted to a goal, measured on points no fit saw, certified.

A `Form` is a function without the values of its coefficients; `fit` finds these, whatever the form,
and returns a `Fit` with its errors and proofs. Rooms: `shapes/` (generic forms), `points/` (where
forms are fitted and judged), `solvers/`, and `proofs/`.
"""

from fitting.errors import Errors as Errors
from fitting.errors import form_values as form_values
from fitting.errors import judge as judge
from fitting.fit import Fit as Fit
from fitting.form import FittedForm as FittedForm
from fitting.form import Form as Form
from fitting.form import Proofs as Proofs
from fitting.form import Stage as Stage
from fitting.goal import Goal as Goal
from fitting.points.domain import Domain as Domain
from fitting.points.domain import common_domain as common_domain
