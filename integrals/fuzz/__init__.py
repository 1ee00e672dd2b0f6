"""Exact values for the fuzz BRDF of Ghost of Tsushima.

`ps`, `g`, `q`, `r` and `velvet` hold the references P_s, G, Q, R and r(k). `sggx` has P_s for any
SGGX matrix, and `radiance` the integrals of the whole BRDF that the ambient model approximates.
`lit` holds the reference E_lit, the part of uniform light that is scattered towards a view.
`phase_scale` solves the equation of a phase function that is reciprocal and conserves energy.
"""
