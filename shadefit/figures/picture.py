"""What a picture is, and whether it can be drawn here."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from matplotlib.figure import Figure

from shadefit.images.optional_libraries import optional_library


@dataclass(frozen=True)
class Picture:
    """A picture: its title, a caption that explains it, and the function that draws it.

    `libraries` are the optional modules that drawing imports.
    """

    title: str
    caption: str
    draw: Callable[[], Figure]
    libraries: tuple[str, ...] = ()


def require_libraries(picture: Picture) -> None:
    """Raise ValueError that says what to install, if a library of a picture is absent."""
    for module in picture.libraries:
        optional_library(module)


def drawable(known: Mapping[str, Picture]) -> tuple[dict[str, Picture], list[str]]:
    """Return the pictures whose libraries are installed, and a line on each of the others."""
    found, lines = {}, []
    for name, picture in known.items():
        try:
            require_libraries(picture)
        except ValueError as absent:
            lines.append(f"{name} is not drawn: {absent}")
        else:
            found[name] = picture
    return found, lines
