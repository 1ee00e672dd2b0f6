"""The quantities of the fuzz BRDF of Ghost of Tsushima: P_s, G, Q, R, and velvet's r(k).

`ps`, `g`, `q`, `r` and `velvet` declare them. `lit` declares E_lit, and `ambient_fit` fits the
constants of the ambient models. Import a quantity from its own module: velvet's needs SciPy's
linear programs, for example, for which the others should not wait.
"""
