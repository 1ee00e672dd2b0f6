"""Rough metal and glass: the microfacet model of Smith and GGX.

`ggx` has the distribution of normals, masking and the BRDF of single scattering. Nothing here
knows of integrals: the albedos that a compensation of energy needs are arguments.
"""

from shading.microfacet.ggx import brdf as brdf
from shading.microfacet.ggx import correlated_visibility as correlated_visibility
from shading.microfacet.ggx import masking as masking
from shading.microfacet.ggx import masking_shadowing as masking_shadowing
from shading.microfacet.ggx import ndf as ndf
from shading.microfacet.ggx import projected_roughness as projected_roughness
from shading.microfacet.ggx import projected_roughness_at as projected_roughness_at
from shading.microfacet.ggx import smith_lambda as smith_lambda
from shading.microfacet.ggx import uncorrelated_visibility as uncorrelated_visibility
from shading.microfacet.ggx import visible_normal_density as visible_normal_density
