"""The picture of `shadefit ambient`: the layer seen from everywhere, exact and by the model."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.colors import Normalize, PowerNorm
from matplotlib.figure import Figure

from shadefit.ambient_errors import Radiances, radiances
from shadefit.figures.style import ERRORS, FIBRE, VALUES, render
from shading import roughness_from_spread

SPREAD, TILT, DENSITY = 0.2, 45.0, 0.2
LIGHTS = ("uniform", "from above", "where fibres point", "against fibres")
MODELS = {"exact": "model, exact functions", "published": "model, published tables"}
# Views: sines of the polar angle up to a cosine of 0.1, and azimuths over half the circle.
_SINES = np.sin(np.linspace(0, np.arccos(0.1), 17))
_AZIMUTHS = np.linspace(0, np.pi, 19)
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
    """Colour the disk of views from its upper half, which the lower mirrors."""
    half = values.reshape(len(_SINES), len(_AZIMUTHS))
    around = np.concatenate([_AZIMUTHS, 2 * np.pi - _AZIMUTHS[-2::-1]])
    whole = np.concatenate([half, half[:, -2::-1]], axis=1)
    x, y = np.outer(_SINES, np.cos(around)), np.outer(_SINES, np.sin(around))
    axis.set(xticks=[], yticks=[], aspect="equal")
    axis.spines[:].set_visible(False)
    return axis.pcolormesh(x, y, whole, shading="gouraud", cmap=colours, norm=norm)
