"""Exact values for the fuzz BRDF of Ghost of Tsushima.

`ps`, `g`, `q`, `r` and `velvet` hold the references P_s, G, Q, R and r(k). `sggx` has P_s for any
SGGX matrix, `cubic_root` the root that its closed form needs, and `radiance` the integrals of the
whole BRDF that the ambient model approximates.
"""
