"""Fits of the piecewise-linear NDF to analytic and measured distributions of normals.

`targets` has what is fitted, `knots` places the knots, `fit` finds the values by linear programs,
and `code` has the functions that are exported as shader code.
"""
