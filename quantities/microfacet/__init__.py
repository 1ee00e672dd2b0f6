"""The quantities of GGX microfacets: E, A and B of its Fresnel split, E_avg, and the samplers.

`directional_albedo`, `fresnel_split`, `average_albedo` and `samplers` declare them. Import a
quantity from its own module, so that it does not wait for the others.
"""
