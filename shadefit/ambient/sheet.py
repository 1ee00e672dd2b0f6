"""The picture of `shadefit ambient`: the layer seen from everywhere, exact and by the model."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.colors import Normalize, PowerNorm
from matplotlib.figure import Figure

from shadefit.ambient.errors import Radiances, radiances
from shadefit.figures.style import ERRORS, FIBRE, VALUES, render
from shading import roughness_from_spread

SPREAD, TILT, DENSITY = 0.2, 45.0, 0.2
LIGHTS = ("uniform", "from above", "where fibres point", "from the side", "against fibres")
MODELS = {"exact": "model, exact functions", "published": "model, published tables"}
# Views: sines of the polar angle up to a cosine of 0.1, and azimuths over the circle: the light
# from the side has no mirror in it.
_SINES = np.sin(np.linspace(0, np.arccos(0.1), 17))
_AZIMUTHS = np.arange(36) * np.pi / 18
# As many chords as this look round; between the azimuths stands the trigonometric interpolation.
_CHORDS = 180
_INCHES = 1.75


def draw_ambient() -> bytes:
    """Draw the layer's radiance over the disk of views, one row a light; returns a PNG."""
    sine, azimuth = (a.ravel() for a in np.meshgrid(_SINES, _AZIMUTHS, indexing="ij"))
    material = float(roughness_from_spread(SPREAD)), np.radians(TILT), DENSITY
    at = np.column_stack([np.tile(material, (len(sine), 1)), np.arcsin(sine), azimuth])
    found = radiances(at)
    return render(lambda: _draw(found))["png"]


def _draw(found: Radiances) -> Figure:
    columns = ["exact", *MODELS.values(), *(f"error of the {name}" for name in MODELS.values())]
    figure = Figure(
        figsize=(_INCHES * len(columns) + 0.4, (_INCHES + 0.05) * len(LIGHTS) + 0.95),
        layout="constrained",
    )
    axes = figure.subplots(len(LIGHTS), len(columns))
    value = error = None
    for row, light in zip(axes, LIGHTS, strict=True):
        column = found.lights.index(light)
        exact = found.exact["layer"][:, column]
        models = [found.models[name]["layer"][:, column] for name in MODELS]
        mean, peak = exact.mean(), max(exact.max(), *(m.max() for m in models))
        for axis, radiance in zip(row, (exact, *models), strict=False):
            value = _disk(axis, radiance / peak, VALUES, PowerNorm(0.5, 0, 1))
        for axis, radiance in zip(row[3:], models, strict=True):
            error = _disk(axis, (radiance - exact) / mean, ERRORS, Normalize(-1, 1))
        row[0].set_ylabel(light)
    # Fibres lean to the right, in the middle of the disk's right half.
    axes[0, 0].plot([0, 0.5], [0, 0], color=FIBRE, marker="o", markevery=[1], markersize=3)
    for axis, title in zip(axes[0], columns, strict=True):
        axis.set_title(title.replace("model, ", "model,\n"))
    assert value is not None
    assert error is not None
    bar: dict[str, Any] = {"location": "bottom", "aspect": 30, "shrink": 0.7}
    figure.colorbar(
        value, ax=axes[:, :3], label="radiance of the layer over the row's largest", **bar
    )
    figure.colorbar(
        error, ax=axes[:, 3:], label="error over the mean exact radiance", extend="both", **bar
    )
    return figure


def _disk(axis: Axes, values: np.ndarray, colours: str, norm: Normalize) -> QuadMesh:
    """Colour the disk of views."""
    around = np.linspace(0, 2 * np.pi, _CHORDS + 1)
    whole = periodic(values.reshape(len(_SINES), len(_AZIMUTHS)), _CHORDS)
    x, y = np.outer(_SINES, np.cos(around)), np.outer(_SINES, np.sin(around))
    # Room for the rim, which would be cut flat by the edges of the axes.
    axis.set(xticks=[], yticks=[], aspect="equal", xlim=(-1.02, 1.02), ylim=(-1.02, 1.02))
    axis.spines[:].set_visible(False)
    return axis.pcolormesh(x, y, whole, shading="gouraud", cmap=colours, norm=norm)


def periodic(values: np.ndarray, count: int) -> np.ndarray:
    """Interpolate rows (m, n), one period each, at `count` equal steps and the end: (m, count + 1).

    By the trigonometric polynomial through the values; `count` is at least n.
    """
    n = values.shape[1]
    spectrum = np.fft.rfft(values, axis=1)
    if n % 2 == 0:
        # The highest frequency stands for two, of which the longer spectrum keeps one.
        spectrum[:, -1] /= 2
    finer = np.fft.irfft(spectrum, count, axis=1) * (count / n)
    return np.concatenate([finer, finer[:, :1]], axis=1)
