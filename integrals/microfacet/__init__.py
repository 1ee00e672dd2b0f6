"""Exact values for GGX microfacets: albedos by direction and on average.

`directional_albedo` has E(μ, α), `fresnel_split` its parts A and B, `average_albedo` E_avg(α).
`sampling_variance` has the variance of the samplers of visible normals.
"""

from integrals.microfacet.average_albedo import average_albedo as average_albedo
from integrals.microfacet.directional_albedo import directional_albedo as directional_albedo
from integrals.microfacet.fresnel_split import FresnelSplit as FresnelSplit
from integrals.microfacet.fresnel_split import fresnel_split as fresnel_split
