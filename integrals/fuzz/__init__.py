"""The fuzz BRDF of Ghost of Tsushima: exact P_s, G, Q, R, r(k), and the layer's radiance."""
