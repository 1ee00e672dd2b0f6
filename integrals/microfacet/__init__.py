"""Exact values of microfacet surfaces."""
