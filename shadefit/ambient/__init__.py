"""The ambient model of the fuzz BRDF against the exact radiance that it approximates.

* `lights`: lights whose spherical harmonics are known exactly
* `radiances`: exact radiances and the model's, for many materials and views; `errors`: statistics
* `energy`: the largest radiances in uniform light
* `sheet`: the picture
"""
