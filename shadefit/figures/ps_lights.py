"""P_s over the hemisphere of lights: spherical plots, and discs that show it from above."""

from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from matplotlib.patches import Circle
from mpl_toolkits.mplot3d import Axes3D

from quantities.fuzz import PS
from shadefit.figures.style import ERRORS, FIBRE, VALUES, space
from shadefit.figures.values import compared_values, hints_of, mesh

# The angles θf of the columns of figures 1 to 4 of the supplement, in degrees.
TILTS = (0.0, 23.0, 45.0)
# The materials (α, θf in degrees) of the discs, one per row.
MATERIALS = ((0.2, 23.0), (0.35, 45.0), (0.35, 80.0))
_PIXELS = 141


def draw_spherical(alpha: float) -> Figure:
    """Draw P_s(u) u over all lights u as a surface.

    The rows are exact, published and refitted; the columns are angles of the fibre.
    """
    figure = Figure(figsize=(7.4, 6.3))
    theta, phi = np.linspace(0, np.pi / 2, 46), np.linspace(0, 2 * np.pi, 97)
    for column, tilt in enumerate(TILTS):
        points = _lights(alpha, tilt, mesh(theta, phi))
        theta_f = np.radians(tilt)
        along_fibre = compared_values(PS, np.array([[alpha, theta_f, theta_f, 0.0]]))
        for row, (label, values) in enumerate(compared_values(PS, points).items()):
            place = (0.05 + 0.315 * column, 0.66 - 0.285 * row, 0.31, 0.31)
            axes = space(figure, place)
            _surface(axes, theta, phi, values)
            _fibre(axes, theta_f, float(along_fibre[label][0]))
            if row == 0:
                figure.text(place[0] + 0.155, 0.965, f"$θ_f$ = {tilt:g}°", ha="center", fontsize=10)
            if column == 0:
                middle = place[1] + 0.15
                figure.text(0.025, middle, label, rotation=90, va="center", fontsize=10)
    bar = figure.add_axes((0.3, 0.062, 0.4, 0.016))
    scale = ScalarMappable(Normalize(0, 1), VALUES)
    figure.colorbar(scale, cax=bar, orientation="horizontal", label=f"$P_s$ for α = {alpha:g}")
    return figure


def draw_discs() -> Figure:
    """Draw P_s and the errors of its tables over the hemisphere of lights, seen from above."""
    figure = Figure(figsize=(9.6, 6.2), layout="constrained")
    grid = figure.subplots(len(MATERIALS), 5)
    values = errors = ScalarMappable()
    line = np.linspace(-1, 1, _PIXELS)
    x, y = np.meshgrid(line, line)
    lights = np.stack([np.arcsin(np.minimum(np.hypot(x, y), 1)), np.arctan2(y, x)], axis=-1)
    hints = hints_of(PS)
    largest = hints.largest_error
    for axes, (alpha, tilt) in zip(grid, MATERIALS, strict=True):
        images = compared_values(PS, _lights(alpha, tilt, lights))
        truth, *fitted = images.values()
        for each, image in zip(axes[:3], images.values(), strict=True):
            values = _disc(each, image, VALUES, 0.0, 1.0)
        for each, image in zip(axes[3:], fitted, strict=True):
            errors = _disc(each, image - truth, ERRORS, -largest, largest)
        axes[0].set_ylabel(f"α = {alpha:g}, $θ_f$ = {tilt:g}°")
    titles = [*images, *(f"{label} − exact" for label in list(images)[1:])]
    for axes, title in zip(grid[0], titles, strict=True):
        axes.set_title(title)
    below: dict[str, Any] = {"location": "bottom", "pad": 0.02, "aspect": 30, "shrink": 0.7}
    figure.colorbar(values, ax=grid[:, :3], label=hints.value_label, **below)
    below |= {"ticks": (-largest, -largest / 2, 0, largest / 2, largest), "extend": "both"}
    figure.colorbar(errors, ax=grid[:, 3:], label="error of $P_s$", **below)
    return figure


def _lights(alpha: float, tilt: float, lights: np.ndarray) -> np.ndarray:
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
    axes.set_box_aspect((2, 2, 1), zoom=1.5)
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
