"""Microfacet surfaces: the samplers of visible normals that are exported as code."""

from quantities.microfacet.samplers import SAMPLERS as SAMPLERS
