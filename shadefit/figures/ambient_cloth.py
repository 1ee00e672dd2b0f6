"""The picture of a cloth in ambient light, exact and by two models of the layer."""

from typing import Any

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from shadefit.ambient.cloth import MODELS, render_cloth
from shadefit.figures.picture import Picture
from shadefit.figures.style import ERRORS
from shadefit.render.srgb import to_srgb

# The edge of an image in inches, and where the colour scale of differences ends.
_INCHES, _LIMIT = 1.75, 1.0


def ambient_pictures() -> dict[str, Picture]:
    """Return the picture of the cloth, by its name."""
    return {
        "ambient-cloth": Picture(
            "A cloth in ambient light",
            "A cloth of crushed velvet in a strong light of nine harmonics, a broad lobe from the "
            "right: by quadrature of the whole BRDF, by the talk's ambient model and by the "
            "recommended one, as exported code computes them. On the right are the differences of "
            "linear luminance from the exact image, divided by its mean.",
            draw_cloth,
        )
    }


def draw_cloth() -> Figure:
    """Draw the cloth: exact, by two models, and the differences of both from the exact one."""
    cloth = render_cloth()
    titles = {"talk": "talk's model"}
    models = {titles.get(k, f"{k} model"): v for k, v in cloth.models.items()}
    images = {"exact": cloth.exact, **models}
    count = len(images) + len(MODELS)
    figure = Figure(figsize=(count * _INCHES + 0.1, _INCHES + 0.95), layout="compressed")
    axes = figure.subplots(1, count)
    for axis, (name, image) in zip(axes, images.items(), strict=False):
        axis.imshow(to_srgb(image))
        axis.set_title(name)
    for axis, name in zip(axes[len(images) :], MODELS, strict=True):
        off = cloth.differences(name)
        axis.imshow(off, cmap=ERRORS, vmin=-_LIMIT, vmax=_LIMIT)
        axis.set_title(f"{name} − exact")
        axis.set_xlabel(f"rms {np.sqrt(np.mean(off**2)):.1%} of the mean")
    for axis in axes:
        axis.set(xticks=[], yticks=[])
        axis.spines[:].set_visible(False)
    bar: dict[str, Any] = {"location": "bottom", "aspect": 30, "shrink": 0.8, "extend": "both"}
    scale = ScalarMappable(Normalize(-_LIMIT, _LIMIT), ERRORS)
    figure.colorbar(scale, ax=axes[len(images) :], label="over the mean luminance", **bar)
    return figure
