"""Maps of anisotropic GGX roughness: formulas of one texel."""
