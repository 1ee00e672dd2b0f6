"""Pictures: the supplement's figures, maps of errors, and cost against error.

`gallery` lists the pictures; `fuzz_pictures` declares those of the fuzz BRDF. Any other quantity is
drawn from its plot hints: by `curves` if it has one axis, by `maps` if it has two.

The names below are imported when they are first used, so that a program that draws one picture does
not wait for the import of all others.
"""

from typing import TYPE_CHECKING

from programs.public_names import import_when_used

if TYPE_CHECKING:
    from shadefit.figures.gallery import pictures as pictures
    from shadefit.figures.picture import Picture as Picture
    from shadefit.figures.picture import drawable as drawable
    from shadefit.figures.picture import require_libraries as require_libraries
    from shadefit.figures.style import render as render

__getattr__, __dir__, __all__ = import_when_used(
    __name__,
    {
        "shadefit.figures.gallery": ("pictures",),
        "shadefit.figures.picture": ("Picture", "drawable", "require_libraries"),
        "shadefit.figures.style": ("render",),
    },
)
