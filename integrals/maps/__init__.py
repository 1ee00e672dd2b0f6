"""Exact values for maps: the width of the one GGX lobe that stands best for many normals."""
