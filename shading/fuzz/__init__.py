"""The fuzz BRDF of Ghost of Tsushima: scattering layer, phase functions, base and ambient model.

`layer` is the scattering layer, `phase` its phase functions. `brdf` combines them with a base.
`ambient` and `deferred` are the two approximations that the game uses. `ambient_models` has better
models of the layer in ambient light, as moments of the light that it sends to a view
(`layer_light`). They need the normals that reflect the view upwards: their cone (`lit_cone`) and
their moments (`lit_moments`). Import the functions from `shading`.
"""
