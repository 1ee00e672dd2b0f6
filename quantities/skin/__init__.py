"""The quantities of skin: the light that it scatters on a cylinder and on a sphere, by channel."""

from quantities.skin.scattering import SKIN_QUANTITIES as SKIN_QUANTITIES
