"""Images in files: PNG, EXR and DDS, read and written with a colour space that is always said.

Pixels are arrays (height, width, channels) of float32. PNG and DDS files hold values in [0, 1], EXR
files any finite values.
"""

from shadefit.images.colour_space import COLOUR_SPACES as COLOUR_SPACES
from shadefit.images.colour_space import convert_colour_space as convert_colour_space
from shadefit.images.colour_space import require_colour_space as require_colour_space
from shadefit.images.image import MAX_BYTES as MAX_BYTES
from shadefit.images.image import MAX_EDGE as MAX_EDGE
from shadefit.images.image import Image as Image
from shadefit.images.image import image_of as image_of
from shadefit.images.image import require_channels as require_channels
from shadefit.images.image import require_power_of_two as require_power_of_two
from shadefit.images.image import require_same_size as require_same_size
from shadefit.images.optional_libraries import optional_library as optional_library
from shadefit.images.reading import read_image as read_image
from shadefit.images.writing import write_image as write_image
