"""P_s over the hemisphere of lights: spherical plots, and discs that show it from above."""

from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from matplotlib.lines import Line2D
from matplotlib.patches import Circle
from mpl_toolkits.mplot3d import Axes3D

from coefficients.catalogue import resolve
from coefficients.exported_code import operations_of
from quantities.fuzz.ps import PS
from shadefit.figures.style import ERRORS, FIBRE, VALUES, space
from shadefit.figures.values import compared_values, error_text, hints_of, label_of, mesh

# The materials of figures 1 to 4 of the supplement: α, a figure each, and θf in degrees.
ALPHAS, TILTS = (0.15, 0.35, 0.55, 0.75), (0.0, 23.0, 45.0)
# The materials (α, θf in degrees) of the discs, one per row.
MATERIALS = ((0.2, 23.0), (0.35, 45.0), (0.35, 80.0))
# Each table with the end of the colour scale of its errors.
_SCALES = {"published/ps": 0.1, "best/ps-25": 0.02, "best/ps-40": 0.0025}
_PIXELS = 141
# The sizes of `draw_spherical` in inches: a row, the space above and below the rows, the columns
# of surfaces and of discs, and the labels on the left.
_ROW, _ABOVE, _BELOW, _SURFACE, _DISC, _LEFT = 1.04, 0.45, 0.85, 1.6, 1.3, 0.65


def draw_spherical() -> Figure:
    """Draw P_s(u) u over all lights u as surfaces, and errors as discs; one row for each material.

    The surfaces are exact, published and best; the discs are the errors of the two tables.
    """
    rows = [(alpha, tilt) for alpha in ALPHAS for tilt in TILTS]
    tables = [resolve(name) for name in ("published/ps", "best/ps-40")]
    width, height = _LEFT + 3 * _SURFACE + 2 * _DISC, _ABOVE + _ROW * len(rows) + _BELOW
    figure = Figure(figsize=(width, height))

    def box(left: float, bottom: float, wide: float, high: float):
        return (left / width, bottom / height, wide / width, high / height)

    theta, phi = np.linspace(0, np.pi / 2, 46), np.linspace(0, 2 * np.pi, 97)
    lights, errors = disc_lights(), []
    for row, (alpha, tilt) in enumerate(rows):
        bottom = height - _ABOVE - _ROW * (row + 1)
        theta_f = np.radians(tilt)
        surfaces = compared_values(PS, _points(alpha, tilt, mesh(theta, phi)), tables)
        ends = compared_values(PS, np.array([[alpha, theta_f, theta_f, 0.0]]), tables)
        for column, (label, values) in enumerate(surfaces.items()):
            axes = space(figure, box(_LEFT + _SURFACE * column, bottom - 0.165, _SURFACE, 1.5))
            _surface(axes, theta, phi, values)
            _fibre(axes, theta_f, float(ends[label][0]))
        truth, *fitted = compared_values(PS, _points(alpha, tilt, lights), tables).values()
        errors = []
        for column, (table, image) in enumerate(zip(tables, fitted, strict=True)):
            left = _LEFT + 3 * _SURFACE + _DISC * column
            axes = figure.add_axes(box(left + 0.19, bottom + 0.06, 0.92, 0.92))
            limit = _SCALES[table.name]
            errors.append(_disc(axes, image - truth, ERRORS, -limit, limit))
        middle = (bottom + 0.5 * _ROW) / height
        figure.text(0.42 / width, middle, f"$θ_f$ = {tilt:g}°", rotation=90, va="center")
        if row % len(TILTS) == 1:
            figure.text(0.1 / width, middle, f"α = {alpha:g}", rotation=90, va="center", size=10.5)
        if row % len(TILTS) == 0 and row:
            line = (bottom + _ROW) / height
            figure.add_artist(Line2D([0, 1], [line, line], color="#bbbbbb", lw=0.7))
    titles = ["exact", *map(label_of, tables)]
    middles = [_LEFT + _SURFACE * (i + 0.5) for i in range(3)]
    for middle, title in zip(middles, titles, strict=True):
        figure.text(middle / width, 1 - 0.29 / height, title, ha="center", size=9.5)
    bar = figure.add_axes(box(_LEFT + 1.0, 0.55, 3 * _SURFACE - 2.0, 0.11))
    scale = ScalarMappable(Normalize(0, 1), VALUES)
    figure.colorbar(scale, cax=bar, orientation="horizontal", label=hints_of(PS).value_label)
    for column, (table, shown) in enumerate(zip(tables, errors, strict=True)):
        left, limit = _LEFT + 3 * _SURFACE + _DISC * column, _SCALES[table.name]
        title = f"{label_of(table)}\n− exact"
        figure.text((left + 0.65) / width, 1 - 0.38 / height, title, ha="center", size=9)
        bar = figure.add_axes(box(left + 0.19, 0.55, 0.92, 0.11))
        below: dict[str, Any] = {"orientation": "horizontal", "ticks": (-limit, 0, limit)}
        figure.colorbar(shown, cax=bar, extend="both", format="{x:g}", label="error", **below)
    return figure


def draw_discs() -> Figure:
    """Draw P_s and the errors of its tables over the hemisphere of lights, seen from above.

    The errors of each table have a colour scale of their own.
    """
    tables = [resolve(name) for name in _SCALES]
    figure = Figure(figsize=(9.6, 5.7), layout="constrained")
    grid = figure.subplots(len(MATERIALS), 6)
    values = ScalarMappable()
    errors = [values] * len(tables)
    for axes, (alpha, tilt) in zip(grid, MATERIALS, strict=True):
        images = compared_values(PS, _points(alpha, tilt, disc_lights()), tables)
        truth, *fitted = images.values()
        for each, image in zip(axes[:3], (truth, fitted[0], fitted[-1]), strict=True):
            values = _disc(each, image, VALUES, 0.0, 1.0)
        # The fibre, seen from above.
        axes[0].plot((0, np.sin(np.radians(tilt))), (0, 0), color=FIBRE, lw=2)
        for i, image in enumerate(fitted):
            limit = _SCALES[tables[i].name]
            errors[i] = _disc(axes[3 + i], image - truth, ERRORS, -limit, limit)
            axes[3 + i].set_xlabel(
                f"largest {error_text(np.abs(image - truth).max())}", fontsize=8.5
            )
        axes[0].set_ylabel(f"α = {alpha:g}, $θ_f$ = {tilt:g}°")
    first = tables[0]
    names = [label_of(table) for table in tables]
    for axes, table in zip(grid[0, 1:3], (first, tables[-1]), strict=True):
        axes.set_title(f"{label_of(table)}\n{operations_of(table)} operations")
    grid[0, 0].set_title("exact\n")
    for axes, name, table in zip(grid[0, 3:], names, tables, strict=True):
        factor = _SCALES[first.name] / _SCALES[table.name]
        axes.set_title(f"{name} − exact\ncolours × {factor:g}")
    below: dict[str, Any] = {"location": "bottom", "pad": 0.02}
    figure.colorbar(
        values, ax=grid[:, :3], label=hints_of(PS).value_label, aspect=30, shrink=0.7, **below
    )
    for i, (table, shown) in enumerate(zip(tables, errors, strict=True)):
        limit = _SCALES[table.name]
        below |= {"ticks": (-limit, 0, limit), "extend": "both", "format": "{x:g}", "aspect": 12}
        figure.colorbar(shown, ax=grid[:, 3 + i], label="error of $P_s$", **below)
    return figure


def disc_lights() -> np.ndarray:
    """Return the lights (…, 2), θu and φ, of the pixels of a disc; outside it they are grazing."""
    line = np.linspace(-1, 1, _PIXELS)
    x, y = np.meshgrid(line, line)
    return np.stack([np.arcsin(np.minimum(np.hypot(x, y), 1)), np.arctan2(y, x)], axis=-1)


def _points(alpha: float, tilt: float, lights: np.ndarray) -> np.ndarray:
    """Return points (…, 4) of one material (α, θf in degrees) and lights (…, 2) of θu and φ."""
    material = np.broadcast_to([alpha, np.radians(tilt)], lights.shape)
    return np.concatenate([material, lights], axis=-1)


def _surface(axes: Axes3D, theta: np.ndarray, phi: np.ndarray, values: np.ndarray) -> None:
    across, height = np.sin(theta)[:, None], np.cos(theta)[:, None]
    xyz = values * np.stack(
        [across * np.cos(phi), across * np.sin(phi), np.broadcast_to(height, values.shape)]
    )
    circle, zero = np.stack([np.cos(phi), np.sin(phi)]), np.zeros(2)
    ends = np.array([-1.0, 1.0])
    for x, y in (circle / 2, circle, (ends, zero), (zero, ends)):
        axes.plot(x, y, np.zeros(len(x)), color="#aaaaaa", lw=0.7, zorder=1, clip_on=False)
    colours = colormaps[VALUES](values)
    colours[..., :3] *= _light_on(xyz)[..., None]
    surface = axes.plot_surface(
        *xyz,
        facecolors=colours,
        shade=False,
        rstride=1,
        cstride=1,
        linewidth=0,
        antialiased=False,
        zorder=2,
        clip_on=False,
    )
    surface.set_rasterized(True)
    axes.set(xlim=(-1, 1), ylim=(-1, 1), zlim=(0, 1))
    axes.set_box_aspect((2, 2, 1), zoom=1.28)
    axes.view_init(elev=24, azim=-62)
    axes.set_axis_off()


def _light_on(xyz: np.ndarray) -> np.ndarray:
    """Return the brightness of a surface (3, θ, φ) under a weak light from the left.

    The light shows the shape; it is weak so that the colours can still be read.
    """
    by_theta, by_phi = np.gradient(xyz, axis=1), np.gradient(xyz, axis=2)
    normals = np.cross(by_theta, by_phi, axis=0)
    # At the pole all meridians meet, so that the derivative by φ is zero.
    normals[:, 0] = normals[:, 1].mean(axis=1, keepdims=True)
    # Where clamped values are 0 the surface is a point, which has no normal.
    normals /= np.maximum(np.linalg.norm(normals, axis=0), np.finfo(float).tiny)
    from_left = np.array([-0.5, -0.6, 0.62])
    return 0.8 + 0.2 * np.tensordot(from_left, normals, axes=1)


def _fibre(axes: Axes3D, theta_f: float, value: float) -> None:
    """Draw the fibre outside the surface: it begins at the surface, at the distance `value`."""
    x, z = (np.array([value, 1.15]) * ratio for ratio in (np.sin(theta_f), np.cos(theta_f)))
    axes.plot(x, [0, 0], z, color=FIBRE, lw=2, zorder=3, clip_on=False)


def _disc(axes: Axes, image: np.ndarray, colours: str, low: float, high: float) -> AxesImage:
    axes.set(xticks=[], yticks=[], aspect="equal")
    axes.spines[:].set_visible(False)
    shown = axes.imshow(
        image, origin="lower", extent=(-1, 1, -1, 1), cmap=colours, vmin=low, vmax=high
    )
    shown.set_clip_path(Circle((0, 0), 1, transform=axes.transData))
    axes.add_patch(Circle((0, 0), 1, fill=False, ec="#777777", lw=0.6, clip_on=False))
    return shown
