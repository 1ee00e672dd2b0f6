"""Integrals of the piecewise-linear NDF: Smith's masking, the directional albedo, and the paper's.

`smith` has Λ, G1 and the height-correlated G2 by a one-dimensional integral for any profile, and by
a closed form for profiles that are linear in cos²θ. `published` and `published_sampling` are the
formulas and algorithms as the paper prints them, errata applied, to compare with.
"""
