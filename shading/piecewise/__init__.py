"""The piecewise-linear distribution of microfacet normals (NDF), and samplers of it.

`ndf` is one isotropic profile D(θ) between knots, `moments` its integrals, `blend` the anisotropic
mixture of two profiles, `roots` solves the equations of azimuths, and `normal_sampling` and
`visible_sampling` draw normals. `slopes` has the analytic NDFs that profiles are made from.
"""
