"""Exact values for GGX microfacets: albedos by direction and on average, and a random walk.

E(μ, α) is in `directional_albedo`, and by independent methods in `visible_ellipse` (which is also
for anisotropic surfaces and any Fresnel reflectance), in `monte_carlo` and in `random_walk`.
`fresnel_split` has the parts A and B of the albedo with Schlick's reflectance, `average_albedo`
has E_avg(α), `fresnel_average` F_avg, and `limits` the limits of E. docs/microfacet.md proves them.
"""

from integrals.microfacet.average_albedo import average_albedo as average_albedo
from integrals.microfacet.average_albedo import average_of_directional as average_of_directional
from integrals.microfacet.directional_albedo import directional_albedo as directional_albedo
from integrals.microfacet.fresnel_average import conductor_average as conductor_average
from integrals.microfacet.fresnel_average import dielectric_average as dielectric_average
from integrals.microfacet.fresnel_average import (
    dielectric_average_by_quadrature as dielectric_average_by_quadrature,
)
from integrals.microfacet.fresnel_average import schlick_average as schlick_average
from integrals.microfacet.fresnel_split import FresnelSplit as FresnelSplit
from integrals.microfacet.fresnel_split import fresnel_split as fresnel_split
from integrals.microfacet.limits import fully_rough_albedo as fully_rough_albedo
from integrals.microfacet.limits import (
    fully_rough_uncorrelated_albedo as fully_rough_uncorrelated_albedo,
)
from integrals.microfacet.limits import normal_albedo as normal_albedo
from integrals.microfacet.limits import smooth_limit as smooth_limit
from integrals.microfacet.monte_carlo import albedo_by_sampling as albedo_by_sampling
from integrals.microfacet.monte_carlo import (
    directional_albedo_by_sampling as directional_albedo_by_sampling,
)
from integrals.microfacet.visible_ellipse import anisotropic_albedo as anisotropic_albedo
from integrals.microfacet.visible_ellipse import (
    directional_albedo_by_ellipse as directional_albedo_by_ellipse,
)
