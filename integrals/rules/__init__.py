"""Quadrature rules on standard domains."""
