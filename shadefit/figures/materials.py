"""What depends on the material alone: R, the errors of P_s over materials, and its rows c_i."""

import jax
import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from coefficients.catalogue import form_of, load
from fitting.cells import fit_cells
from fitting.paper import RationalPs
from fitting.points.grids import light_directions, trapezoid_grid
from integrals import PS, R
from shadefit.figures.maps import error_maps, surfaces
from shadefit.figures.style import ERRORS
from shadefit.figures.values import exact, exported, mesh

_ALPHA, _THETA_F = RationalPs.axes[:2]
PRINTED = "published/ps@printed"
TABLES = {
    "published, as printed": PRINTED,
    "published, rows exchanged": "published/ps",
    "refitted": "ps",
}
# The rows of the published table that are exchanged.
EXCHANGED = (3, 4)


def draw_r() -> Figure:
    """Draw R over θf and α: exact, published, refitted."""
    labels = ("α", "$θ_f$ / rad", "$R$")
    return surfaces(R, _materials(41), labels, (0.0, 1.0), azimuth=-40.0)


def draw_r_errors() -> Figure:
    """Map R and the signed errors of its tables over α and θf."""
    labels = ("α", "fibre's angle $θ_f$ / °")
    return error_maps(R, _materials(61), labels, 1e-3, units=(1.0, 180 / np.pi))


def draw_ps_errors(count: int = 49, directions: int = 16) -> Figure:
    """Map the rms and the largest error of P_s over directions, for every material and table."""
    figure = Figure(figsize=(9.6, 5.6), layout="constrained")
    grid = figure.subplots(2, len(TABLES), sharex=True, sharey=True)
    alphas, tilts, errors = ps_errors(count, directions)
    scale = LogNorm(1e-3, 0.5)
    shown = ScalarMappable()
    for column, (label, (rms, largest)) in zip(grid.T, errors.items(), strict=True):
        for axes, image in zip(column, (rms, largest), strict=True):
            shown = axes.pcolormesh(
                np.degrees(tilts), alphas, image, norm=scale, cmap="magma_r", rasterized=True
            )
            axes.set_yticks([0.25, 0.5, 0.75, 1.0])
        column[0].set_title(label)
        column[1].set_xlabel("fibre's angle $θ_f$ / °")
    grid[0, 0].set_ylabel("rms over lights\nα")
    grid[1, 0].set_ylabel("largest over lights\nα")
    figure.colorbar(shown, ax=grid, label="error of $P_s$", extend="both", aspect=40)
    return figure


def ps_errors(count: int, directions: int):
    """Give the rms and largest error of each table of P_s over lights, for count² materials.

    Lights are `directions`² Gauss–Legendre and midpoint nodes, uniform in θu and φ. Returns α
    (count,), θf (count,), and by label a pair of (count, count) arrays, α first.
    """
    alphas = np.linspace(_ALPHA.lower, _ALPHA.upper, count)
    tilts = np.linspace(_THETA_F.lower, _THETA_F.upper, count)
    lights, weights = light_directions(PS.axes[2], directions, "uniform")
    materials = mesh(alphas, tilts)[:, :, None, :]
    shape = (count, count, len(lights), 2)
    points = np.concatenate(
        [np.broadcast_to(materials, shape), np.broadcast_to(lights, shape)], axis=-1
    )
    truth = exact(PS, points)
    errors = {}
    for label, name in TABLES.items():
        apart = np.abs(exported(name, points) - truth)
        errors[label] = np.sqrt(apart**2 @ weights), apart.max(axis=-1)
    return alphas, tilts, errors


def draw_rows(count: int = 33) -> Figure:
    """Draw c₀ … c₅ over materials: best in each cell, published as printed, exchanged, refitted."""
    alphas, tilts, rows = ps_rows(count)
    figure = Figure(figsize=(9.6, 6.4), layout="constrained")
    grid = figure.subplots(len(rows), 6, sharex=True, sharey=True)
    limits = np.ceil(np.abs(rows["best in each cell"]).max(axis=(0, 1)) * 10) / 10
    for row, (label, values) in enumerate(rows.items()):
        for i, axes in enumerate(grid[row]):
            shown = axes.pcolormesh(
                np.degrees(tilts),
                alphas,
                values[..., i],
                cmap=ERRORS,
                vmin=-limits[i],
                vmax=limits[i],
                rasterized=True,
            )
            if label == "published, as printed" and i in EXCHANGED:
                axes.spines[:].set(visible=True, color="#d55e00", linewidth=2.5)
            if row == len(rows) - 1:
                axes.set_xlabel("$θ_f$ / °")
                figure.colorbar(shown, ax=grid[:, i], location="bottom", aspect=12, extend="both")
            if row == 0:
                axes.set_title(f"$c_{i}$  ({_TERMS[i]})")
        grid[row, 0].set_ylabel(f"{label.replace(', ', chr(10))}\nα")
    return figure


_TERMS = ("1", "u·n", "u·t", "(u·n)²", "(u·n)(u·t)", "(u·t)²")


def ps_rows(count: int) -> tuple[np.ndarray, np.ndarray, dict[str, np.ndarray]]:
    """Give c₀ … c₅ for count² materials: α (count,), θf (count,), and (count, count, 6) by label.

    The first is the least squares optimum of each material by itself.
    """
    grid = trapezoid_grid((_ALPHA, _THETA_F), count)
    alphas, tilts = grid.nodes
    points = mesh(alphas, tilts)
    rows = {"best in each cell": np.asarray(fit_cells(grid, "uniform").coefficients)}
    for label, name in TABLES.items():
        form = form_of(load(name))
        assert isinstance(form, RationalPs)
        rows[label] = np.asarray(jax.vmap(jax.vmap(form.material))(points[..., 0], points[..., 1]))
    return alphas, tilts, rows


def _materials(count: int) -> np.ndarray:
    alpha, theta_f = R.axes
    low = _ALPHA.lower
    return mesh(
        np.linspace(low, alpha.upper, count), np.linspace(theta_f.lower, theta_f.upper, count)
    )
