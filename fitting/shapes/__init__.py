"""Formulas that forms of several quantities share: polynomials, poles, quotients, surfaces."""
