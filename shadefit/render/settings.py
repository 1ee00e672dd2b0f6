"""What the user chooses for a rendering: the material, the lights, the fibres and the size."""

from dataclasses import dataclass

import numpy as np

from shadefit.render.shade import Light, Material
from shadefit.render.srgb import parse_colour


@dataclass(frozen=True)
class Settings:
    """The choices for a rendering.

    * `density`, `spread`: of the layer. `tilt`: polar angle of the fibres in radians.
    * `fiber`, `base`: sRGB colours as '#rrggbb'.
    * `sun`: irradiance of the sun. `sun_height`: its angle above the horizon in radians.
    * `sun_azimuth`: angle from the right in radians, anticlockwise; the camera looks along π/2.
    * `sky`: radiance of the sky.
    * `fibers`: where the fibres lean: 'even', 'crushed', or the path of a PNG file.
    * `size`: pixels along each edge of the image.
    """

    density: float = 0.2
    spread: float = 0.2
    tilt: float = float(np.radians(23))
    fiber: str = "#ff6f9c"
    base: str = "#7a0f2b"
    sun: float = 7.0
    sun_height: float = float(np.radians(40))
    sun_azimuth: float = float(np.radians(215))
    sky: float = 1.2
    fibers: str = "crushed"
    size: int = 256

    @property
    def material(self) -> Material:
        """The layer and its base. Raises ValueError for a colour that cannot be read."""
        fiber, base = parse_colour(self.fiber, "fiber"), parse_colour(self.base, "base")
        return Material(self.density, self.spread, self.tilt, fiber, base)

    @property
    def light(self) -> Light:
        """The sun and the sky."""
        flat = np.cos(self.sun_height)
        x, y = flat * np.cos(self.sun_azimuth), flat * np.sin(self.sun_azimuth)
        return Light((float(x), float(y), float(np.sin(self.sun_height))), self.sun, self.sky)
