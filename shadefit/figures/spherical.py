"""P_s over the hemisphere of lights: spherical plots, and discs seen from above with the errors."""

from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Circle
from mpl_toolkits.mplot3d import Axes3D

from integrals import PS
from shadefit.figures.style import ERRORS, FIBRE, VALUES, space
from shadefit.figures.values import exact, exported, mesh

TILTS = (0.0, 23.0, 45.0)
_ROWS = {"exact": None, "published": "published/ps", "refitted": "ps"}
# Materials (α, θf in degrees) of the discs, one row each.
MATERIALS = ((0.2, 23.0), (0.35, 45.0), (0.35, 80.0))
_ERROR = 0.1
_PIXELS = 141


def draw_spherical(alpha: float) -> Figure:
    """Draw P_s(u) u over all lights u as a surface: exact, published and refitted, by tilt."""
    figure = Figure(figsize=(7.4, 6.3))
    theta, phi = np.linspace(0, np.pi / 2, 46), np.linspace(0, 2 * np.pi, 97)
    for column, tilt in enumerate(TILTS):
        points = _lights(alpha, tilt, mesh(theta, phi))
        for row, (label, table) in enumerate(_ROWS.items()):
            place = (0.05 + 0.315 * column, 0.66 - 0.285 * row, 0.31, 0.31)
            axes = space(figure, place)
            values = exact(PS, points) if table is None else exported(table, points)
            _surface(axes, theta, phi, values)
            _fibre(axes, alpha, tilt, table)
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
    titles = [*_ROWS, *(f"{label} − exact" for label in list(_ROWS)[1:])]
    figure = Figure(figsize=(9.6, 6.2), layout="constrained")
    grid = figure.subplots(len(MATERIALS), len(titles))
    values = errors = ScalarMappable()
    line = np.linspace(-1, 1, _PIXELS)
    x, y = np.meshgrid(line, line)
    lights = np.stack([np.arcsin(np.minimum(np.hypot(x, y), 1)), np.arctan2(y, x)], axis=-1)
    for axes, (alpha, tilt) in zip(grid, MATERIALS, strict=True):
        points = _lights(alpha, tilt, lights)
        truth = exact(PS, points)
        fitted = [exported(table, points) for table in _ROWS.values() if table is not None]
        for each, image in zip(axes[:3], [truth, *fitted], strict=True):
            values = _disc(each, image, VALUES, 0.0, 1.0)
        for each, image in zip(axes[3:], fitted, strict=True):
            errors = _disc(each, image - truth, ERRORS, -_ERROR, _ERROR)
        axes[0].set_ylabel(f"α = {alpha:g}, $θ_f$ = {tilt:g}°")
    for axes, title in zip(grid[0], titles, strict=True):
        axes.set_title(title)
    label = "fraction scattered to the base, $P_s$"
    below: dict[str, Any] = {"location": "bottom", "pad": 0.02, "aspect": 30, "shrink": 0.7}
    figure.colorbar(values, ax=grid[:, :3], label=label, **below)
    below |= {"ticks": (-_ERROR, -_ERROR / 2, 0, _ERROR / 2, _ERROR), "extend": "both"}
    figure.colorbar(errors, ax=grid[:, 3:], label="error of $P_s$", **below)
    return figure


def _lights(alpha: float, tilt: float, lights: np.ndarray) -> np.ndarray:
    """Put the material (α, θf in degrees) before lights (…, 2) of θu and φ: points (…, 4)."""
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
    """Shade a surface (3, θ, φ) a little, so that its shape shows and its colours stay legible."""
    by_theta, by_phi = np.gradient(xyz, axis=1), np.gradient(xyz, axis=2)
    normals = np.cross(by_theta, by_phi, axis=0)
    # At the pole the meridians meet: there is no direction along φ.
    normals[:, 0] = normals[:, 1].mean(axis=1, keepdims=True)
    normals /= np.linalg.norm(normals, axis=0)
    from_left = np.array([-0.5, -0.6, 0.62])
    return 0.8 + 0.2 * np.tensordot(from_left, normals, axes=1)


def _fibre(axes: Axes3D, alpha: float, tilt: float, table: str | None) -> None:
    """Draw the fibre from where it leaves the surface outwards."""
    theta_f = np.radians(tilt)
    point = np.array([[alpha, theta_f, theta_f, 0.0]])
    leaves = float((exact(PS, point) if table is None else exported(table, point))[0])
    x, z = (np.array([leaves, 1.15]) * ratio for ratio in (np.sin(theta_f), np.cos(theta_f)))
    axes.plot(x, [0, 0], z, color=FIBRE, lw=2, zorder=3, clip_on=False)


def _disc(axes, image: np.ndarray, colours: str, low: float, high: float):
    axes.set(xticks=[], yticks=[], aspect="equal")
    axes.spines[:].set_visible(False)
    shown = axes.imshow(
        image, origin="lower", extent=(-1, 1, -1, 1), cmap=colours, vmin=low, vmax=high
    )
    shown.set_clip_path(Circle((0, 0), 1, transform=axes.transData))
    axes.add_patch(Circle((0, 0), 1, fill=False, ec="#777777", lw=0.6, clip_on=False))
    return shown
