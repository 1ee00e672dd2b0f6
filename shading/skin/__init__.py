"""Skin: how far light spreads below the surface, as diffusion profiles of distance.

`profiles` has d'Eon's sum of six Gaussians for the three channels and Burley's profile, radial (per
area) and linear (per length, across a line). Nothing here knows of curved surfaces: those are in
`integrals/skin`.
"""

from shading.skin.profiles import PENNER_WIDENED as PENNER_WIDENED
from shading.skin.profiles import SKIN as SKIN
from shading.skin.profiles import GaussianProfile as GaussianProfile
from shading.skin.profiles import burley as burley
from shading.skin.profiles import burley_as_gaussians as burley_as_gaussians
from shading.skin.profiles import linear as linear
from shading.skin.profiles import radial as radial
