"""The fuzz BRDF of Ghost of Tsushima: layer, phase functions, base, ambient model."""
