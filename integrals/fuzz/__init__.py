"""The fuzz BRDF of Ghost of Tsushima: exact P_s, G, Q, R and r(k), and the radiance of the layer."""
