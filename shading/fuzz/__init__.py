"""The fuzz BRDF of Ghost of Tsushima: scattering layer, phase functions, base and ambient model.

`layer` is the scattering layer, `phase` its phase functions. `brdf` combines them with a base.
`ambient` and `deferred` are the two approximations that the game uses. Import the functions from
`shading`.
"""
