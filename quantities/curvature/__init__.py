"""Curvature of a surface from its tensor and a light, and its packing, as shader code."""

from quantities.curvature.shader import CURVATURES as CURVATURES
