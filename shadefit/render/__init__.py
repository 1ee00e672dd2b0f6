"""A small renderer of fuzz and of rough metal: the same scene with exact functions and with tables.

* `scenes`: what a camera sees of a sphere or a cloth; `fibers`: where the fibres lean
* `functions`: P_s, G, Q and R, exact or as a set of tables is exported
* `settings`: what the user chooses; `shade`: the radiance of samples; `image`: their averages
* `comparison`: images with tables against the exact one; `sheet` and `sweep`: pictures of them
* `metal`: a sphere of rough metal, with and without multiple scattering
* `srgb`: colours
"""
