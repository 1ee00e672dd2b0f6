"""Pictures: the supplement's figures, maps of errors, and cost against error.

`gallery` lists the pictures; `fuzz_pictures` declares those of the fuzz BRDF. Any other quantity is
drawn from its plot hints: by `curves` if it has one axis, by `maps` if it has two.
"""

from shadefit.figures.gallery import pictures as pictures
from shadefit.figures.picture import Picture as Picture
from shadefit.figures.picture import drawable as drawable
from shadefit.figures.picture import require_libraries as require_libraries
from shadefit.figures.style import render as render
