"""Rough metal and glass: the microfacet model of Smith and GGX.

`ggx` has the distribution of normals, masking and the BRDF of single scattering, `fresnel` the
reflectances of facets, and `kulla_conty` the light that is scattered more than once. Nothing here
knows of integrals: the albedos that a compensation of energy needs are arguments.
"""

from shading.microfacet.fresnel import conductor as conductor
from shading.microfacet.fresnel import dielectric as dielectric
from shading.microfacet.fresnel import schlick as schlick
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
from shading.microfacet.kulla_conty import color_by_hill as color_by_hill
from shading.microfacet.kulla_conty import color_by_kulla_conty as color_by_kulla_conty
from shading.microfacet.kulla_conty import color_of_walk as color_of_walk
from shading.microfacet.kulla_conty import multiple_scattering as multiple_scattering
from shading.microfacet.kulla_conty import turquin_scale as turquin_scale
