"""Formulas that forms of several quantities share, and generic forms of any quantity.

Each of these functions returns a `Form` of a reference: `rational` and `polynomial` in any set of
monomials, `chebyshev`, `exponentials`, `pole_sum` and `piecewise_linear`. `powers` lists exponents.
The other modules have formulas: polynomials, poles, quotients, surfaces.
"""

from fitting.shapes.chebyshev_sums import chebyshev as chebyshev
from fitting.shapes.exponential_sums import exponentials as exponentials
from fitting.shapes.monomial_sums import powers as powers
from fitting.shapes.piecewise import piecewise_linear as piecewise_linear
from fitting.shapes.pole_sums import pole_sum as pole_sum
from fitting.shapes.rationals import polynomial as polynomial
from fitting.shapes.rationals import rational as rational
