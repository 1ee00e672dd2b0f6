"""Solvers: how the coefficients of a form are found.

* `on_grid`: least squares on a tensor grid, for any form (the default on a grid)
* `quotients`: the same for quotients of known features
* `separable`: the same for forms of two stages whose second stage is linear. `node_fits` fits the
  nodes of its grid.
* `exchange`: fits to scattered points, for any goal. It calls `scattered_squares` (least squares
  from several starts, by `descent`), `starts` (starts of quotients), `minimax` (the
  largest error, by `linear_programs`) and `extrema` (where the error is largest). `residuals` has
  the errors as functions of the coefficients, and `elsewhere` looks for larger errors outside the
  points of a fit.
* `within_margins`: the least largest error at scattered points, under constraints that are linear
  in the coefficients
* `given`: coefficients that are known, in the place of a solver
* `least_squares`: linear and nonlinear least squares, which the solvers on a grid call
"""
