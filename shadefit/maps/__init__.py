"""Maps of anisotropic GGX lobes: filters for mip chains, synthetic maps, and errors of filters."""
