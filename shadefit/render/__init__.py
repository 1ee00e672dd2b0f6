"""A small renderer that draws the fuzz BRDF with exact functions and with tables."""
