"""What a picture is."""

from collections.abc import Callable
from dataclasses import dataclass

from matplotlib.figure import Figure


@dataclass(frozen=True)
class Picture:
    """A picture: its title, a caption that explains it, and the function that draws it."""

    title: str
    caption: str
    draw: Callable[[], Figure]
