"""Maps of anisotropic GGX lobes: filters for mip chains, encodings, synthetic maps, and errors."""
