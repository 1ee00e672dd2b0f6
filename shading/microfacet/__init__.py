"""Microfacet surfaces: GGX, and the sampling of its visible normals."""
