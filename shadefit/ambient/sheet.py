"""A picture that `shadefit ambient` draws: the layer from all views, exact and by two models."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.colors import Normalize, PowerNorm
from matplotlib.figure import Figure

from shadefit.ambient.lights import lights
from shadefit.ambient.models import model_weights, views
from shadefit.ambient.radiances import layer_responses
from shadefit.figures.style import ERRORS, FIBRE, VALUES, render
from shading import roughness_from_spread

# The material; the tilt is in degrees.
SPREAD, TILT, DENSITY = 0.2, 45.0, 0.2
LIGHTS = ("uniform", "from above", "where fibres point", "from the side", "against fibres")
MODELS = {"talk": "talk's model", "recommended": "recommended model"}
# The views: sines of the polar angle, from the normal to a cosine of 0.1, and azimuths over the
# whole circle, because the radiance in light from the side has no mirror symmetry.
_SINES = np.sin(np.linspace(0, np.arccos(0.1), 17))
_AZIMUTHS = np.arange(36) * np.pi / 18
# The disk of views is drawn with this many azimuths, between which it looks round. Radiances are
# computed at fewer azimuths and interpolated.
_CHORDS = 180
# Width and height of one disk on the sheet.
_INCHES = 1.2


def draw_ambient() -> bytes:
    """Return a PNG with a row for each light: the layer's radiance and errors over all views."""
    sine, azimuth = (a.ravel() for a in np.meshgrid(_SINES, _AZIMUTHS, indexing="ij"))
    material = float(roughness_from_spread(SPREAD)), np.radians(TILT), DENSITY
    at = np.column_stack([np.tile(material, (len(sine), 1)), np.arcsin(sine), azimuth])
    harmonic, view = np.stack([lights()[name] for name in LIGHTS], axis=1), views(at)
    exact = layer_responses(at) @ harmonic
    models = [model_weights(name, view, at) @ harmonic for name in MODELS]
    return render(lambda: _draw(exact, models))["png"]


def _draw(every_exact: np.ndarray, every_model: list[np.ndarray]) -> Figure:
    columns = ["exact", *MODELS.values(), *(f"error of the {name}" for name in MODELS.values())]
    figure = Figure(
        figsize=(_INCHES * len(columns) + 0.4, (_INCHES + 0.05) * len(LIGHTS) + 0.95),
        layout="constrained",
    )
    axes = figure.subplots(len(LIGHTS), len(columns))
    value = error = None
    for column, (row, light) in enumerate(zip(axes, LIGHTS, strict=True)):
        exact, models = every_exact[:, column], [each[:, column] for each in every_model]
        mean, peak = exact.mean(), max(exact.max(), *(m.max() for m in models))
        for axis, radiance in zip(row, (exact, *models), strict=False):
            value = _disk(axis, radiance / peak, VALUES, PowerNorm(0.5, 0, 1))
        for axis, radiance in zip(row[3:], models, strict=True):
            error = _disk(axis, (radiance - exact) / mean, ERRORS, Normalize(-1, 1))
        row[0].set_ylabel(light)
    # The line from the centre shows the direction in which the fibres lean.
    axes[0, 0].plot([0, 0.5], [0, 0], color=FIBRE, marker="o", markevery=[1], markersize=3)
    for axis, title in zip(axes[0], columns, strict=True):
        # One line would be wider than a disk, and cut off at the edge of the sheet.
        axis.set_title(
            title.replace("of the ", "of the\n").replace("recommended ", "recommended\n")
        )
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
    """Draw values of all views on a disk: the radius is the sine of the polar angle."""
    around = np.linspace(0, 2 * np.pi, _CHORDS + 1)
    whole = interpolate_period(values.reshape(len(_SINES), len(_AZIMUTHS)), _CHORDS)
    x, y = np.outer(_SINES, np.cos(around)), np.outer(_SINES, np.sin(around))
    # Limits of ±1 would cut the rim of the disk.
    axis.set(xticks=[], yticks=[], aspect="equal", xlim=(-1.02, 1.02), ylim=(-1.02, 1.02))
    axis.spines[:].set_visible(False)
    return axis.pcolormesh(x, y, whole, shading="gouraud", cmap=colours, norm=norm)


def interpolate_period(values: np.ndarray, count: int) -> np.ndarray:
    """Interpolate periodic rows (m, n) at `count` ≥ n equal steps, by a trigonometric polynomial.

    The result (m, count + 1) ends with the first value again, to close the circle.
    """
    n = values.shape[1]
    spectrum = np.fft.rfft(values, axis=1)
    if n % 2 == 0:
        # The last element is the sum of the frequencies ±n/2, which the longer spectrum separates.
        spectrum[:, -1] /= 2
    finer = np.fft.irfft(spectrum, count, axis=1) * (count / n)
    return np.concatenate([finer, finer[:, :1]], axis=1)
