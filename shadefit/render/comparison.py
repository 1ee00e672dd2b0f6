"""A scene rendered with tables, against the same scene rendered with exact functions."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from shadefit.render.functions import EXACT, table_sets
from shadefit.render.image import Progress, render_images, silent
from shadefit.render.scenes import Scene
from shadefit.render.settings import Settings

# Weights of linear RGB in luminance (ITU-R BT.709).
_LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


@dataclass(frozen=True)
class Comparison:
    """Linear images (h, w, 3) of a scene: the exact one, and one for each set of tables by name."""

    scene: Scene
    exact: np.ndarray
    tables: dict[str, np.ndarray]

    def difference(self, name: str) -> np.ndarray:
        """Return the luminance (h, w) of a set's image minus that of the exact image."""
        return (self.tables[name] - self.exact) @ _LUMINANCE

    def statistics(self) -> list[dict]:
        """Return a row for each set of tables: mean exact luminance, rms and largest difference."""
        rows = []
        for name in self.tables:
            difference = self.difference(name)
            rows.append(
                {
                    "scene": self.scene.name,
                    "tables": name,
                    "mean": float(np.mean(self.exact @ _LUMINANCE)),
                    "rms": float(np.sqrt(np.mean(difference**2))),
                    "max": float(np.abs(difference).max()),
                }
            )
        return rows


def compare(scene: Scene, settings: Settings, progress: Progress = silent) -> Comparison:
    """Render a scene with exact functions and with every set of tables."""
    every = (EXACT, *table_sets())
    exact, *others = render_images(scene, [(settings, each) for each in every], progress)
    names = [each.name for each in every[1:]]
    return Comparison(scene, exact, dict(zip(names, others, strict=True)))


def exr_channels(comparisons: Sequence[Comparison]) -> dict[str, np.ndarray]:
    """Return the channels of all images, by name, for one OpenEXR file.

    R, G and B, which viewers show first, are the first exact image. The others have names such as
    'sphere.published.R'.
    """
    layers = {
        f"{each.scene.name}.{name}.": pixels
        for each in comparisons
        for name, pixels in (("exact", each.exact), *each.tables.items())
    }
    layers[""] = comparisons[0].exact
    return {
        f"{layer}{channel}": pixels[..., i]
        for layer, pixels in layers.items()
        for i, channel in enumerate("RGB")
    }
