"""The picture of the encodings of anisotropic roughness: the worst errors over the widths."""

import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from shadefit.figures.picture import Picture
from shadefit.maps.encoding_errors import LEAST_WIDTH, errors_at
from shading.maps.encodings import ENCODINGS

# Widths along each axis, and angles and widths that are tried within each pixel
_WIDTHS, _TRIED = 40, 400
_BITS = 8


def encoding_pictures() -> dict[str, Picture]:
    """Return the picture of the encodings, by name."""
    return {
        "aniso-encodings": Picture(
            "Encodings of anisotropic roughness",
            "The largest total variation between a GGX lobe with the widths αt ≥ αb and the lobe "
            "that is decoded from three channels of 8 bits, over 400 angles and neighbouring "
            "widths a pixel. The published encoding fails for long lobes, because one code "
            "changes their width by its own size. The others have the same bits.",
            draw_encodings,
        )
    }


def worst_errors(name: str) -> np.ndarray:
    """Return the largest errors (αb, αt) of a grid of logarithms of widths; NaN for αb > αt."""
    ends = np.linspace(np.log(LEAST_WIDTH), 0.0, _WIDTHS + 1)
    rng = np.random.default_rng(5)
    found = np.full((_WIDTHS, _WIDTHS), np.nan)
    across, along = np.nonzero(np.tri(_WIDTHS, dtype=bool).T)
    step = ends[1] - ends[0]
    shape = len(along), _TRIED
    logs = np.stack([ends[each][:, None] + step * rng.random(shape) for each in (along, across)])
    logs = np.sort(np.minimum(logs, 0.0), axis=0)[::-1]
    theta = rng.uniform(-np.pi / 2, np.pi / 2, shape)
    points = np.stack([*logs, theta], axis=-1).reshape(-1, 3)
    found[across, along] = errors_at(name, points, _BITS).reshape(shape).max(axis=1)
    return found


def draw_encodings() -> Figure:
    """Draw the largest error of every encoding over the widths."""
    figure = Figure(figsize=(9.4, 2.9), layout="constrained")
    axes = figure.subplots(1, len(ENCODINGS), sharex=True, sharey=True)
    ends = np.exp(np.linspace(np.log(LEAST_WIDTH), 0.0, _WIDTHS + 1))
    norm = LogNorm(0.003, 0.5)
    for panel, name in zip(axes, ENCODINGS, strict=True):
        errors = worst_errors(name)
        image = panel.pcolormesh(ends, ends, errors, norm=norm, cmap="viridis", rasterized=True)
        panel.set(xscale="log", yscale="log", xlabel="αt", box_aspect=1)
        panel.set_title(f"{name}\nlargest {np.nanmax(errors):.3f}")
        ticks = [0.03, 0.1, 0.3, 1.0]
        panel.set_xticks(ticks, [f"{each:g}" for each in ticks])
        panel.set_yticks(ticks, [f"{each:g}" for each in ticks])
        panel.minorticks_off()
    axes[0].set_ylabel("αb")
    bar = figure.colorbar(image, ax=axes, label="total variation", extend="both")
    bar.set_ticks([0.003, 0.01, 0.03, 0.1, 0.3], labels=["0.003", "0.01", "0.03", "0.1", "0.3"])
    return figure
