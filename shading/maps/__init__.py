"""Formulas of one texel of material maps: GGX lobes about mapped normals as SGGX matrices."""
