"""Compact forms of the integrals: fitted by least squares, measured off the grid, certified.

A `Form` evaluates one point and carries its coefficients; a `Grid` is where it is fitted; a `Fit`
is the result with its errors and the proof that it has no pole in its domain.
"""

from fitting.errors import Errors as Errors
from fitting.errors import exact_values as exact_values
from fitting.errors import form_values as form_values
from fitting.errors import judge as judge
from fitting.errors import measure as measure
from fitting.errors import off_grid_errors as off_grid_errors
from fitting.errors import off_grid_reference as off_grid_reference
from fitting.fit import Fit as Fit
from fitting.fit import refit as refit
from fitting.form import Form as Form
from fitting.goal import Goal as Goal
from fitting.improve import improve as improve
from fitting.paper import PAPER_FORMS as PAPER_FORMS
from fitting.paper import QuadraticQ as QuadraticQ
from fitting.paper import RationalG as RationalG
from fitting.paper import RationalPs as RationalPs
from fitting.paper import RationalR as RationalR
from fitting.points.domain import Domain as Domain
from fitting.points.domain import common_domain as common_domain
from fitting.points.grids import WEIGHTS as WEIGHTS
from fitting.points.grids import Grid as Grid
from fitting.points.grids import Weight as Weight
from fitting.proofs.pole_proof import Certificate as Certificate
from fitting.proofs.pole_proof import certify_denominators as certify_denominators
