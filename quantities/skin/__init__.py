"""The quantities of skin: the light that it scatters on a cylinder and on a sphere, by channel.

`scattering` has D of each channel, and `lobes` that of one Gaussian, of which any profile is a
mean. `bands` has the factors of light in spherical harmonics.
"""

from quantities.skin.bands import BAND_QUANTITIES as BAND_QUANTITIES
from quantities.skin.lobes import LOBE_QUANTITIES as LOBE_QUANTITIES
from quantities.skin.scattering import SKIN_QUANTITIES as SKIN_QUANTITIES
