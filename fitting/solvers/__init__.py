"""Solvers: how the coefficients of a form are found.

* `on_grid`: least squares on a tensor grid, for any form (the default on a grid)
* `quotients`: the same for quotients of known features
* `separable`: the same for forms of two stages whose second stage is linear
* `exchange`: fits to scattered points for any goal; `minimax` minimises the largest error
* `least_squares`: linear and nonlinear least squares, which the others call
"""
