"""The ambient model of the fuzz BRDF against the integral that it stands for."""
