"""P_s by material: the errors of its tables over all lights, and its coefficients c₀ … c₅."""

import jax
import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from coefficients.catalogue import AS_PRINTED, Entry, resolve
from coefficients.exported_code import exported_values
from fitting.points.grids import trapezoid_grid
from fitting.solvers.separable import Separable
from quantities.fuzz.lights import light_directions
from quantities.fuzz.ps import PS
from shadefit.figures.style import ERRORS
from shadefit.figures.values import axis_hints, exact, mesh, points_along

PRINTED = f"published/ps{AS_PRINTED}"
TABLES = {
    "published, as printed": PRINTED,
    "published, rows exchanged": "published/ps",
    "refitted": "ps",
}
# The tables whose errors are mapped.
COMPARED = {**TABLES, "best/ps-25": "best/ps-25", "best/ps-40": "best/ps-40"}
BEST = "each material, by itself"
# The rows of the published table that are exchanged.
EXCHANGED = (3, 4)
# What c₀ … c₅ of Eq. (1) are multiplied by.
_TERMS = ("1", "u·n", "u·t", "(u·n)²", "(u·n)(u·t)", "(u·t)²")
_HINTS = [hint for _, hint in axis_hints(PS)[:2]]
_TILT = _HINTS[1]


def draw_ps_errors(count: int = 49, directions: int = 16) -> Figure:
    """Map the rms and the largest error of P_s over lights, for every material and table."""
    figure = Figure(figsize=(9.6, 4.6), layout="constrained")
    grid = figure.subplots(2, len(COMPARED), sharex=True, sharey=True)
    alphas, tilts, errors = ps_errors(count, directions)
    scale = LogNorm(1e-4, 0.5)
    shown = ScalarMappable()
    for column, (label, (rms, largest)) in zip(grid.T, errors.items(), strict=True):
        for axes, image in zip(column, (rms, largest), strict=True):
            shown = axes.pcolormesh(
                tilts * _TILT.factor, alphas, image, norm=scale, cmap="magma_r", rasterized=True
            )
            axes.set_yticks([0.25, 0.5, 0.75, 1.0])
        column[0].set_title(label.replace(", ", ",\n"))
        column[1].set_xlabel(f"{_TILT.short_label} / {_TILT.unit}")
    grid[0, 0].set_ylabel("rms over lights\nα")
    grid[1, 0].set_ylabel("largest over lights\nα")
    figure.colorbar(shown, ax=grid, label="error of $P_s$", extend="both", aspect=30)
    return figure


def ps_errors(count: int, directions: int):
    """Return the rms and largest error of each table of P_s over lights, for count² materials.

    Lights are `directions`² Gauss–Legendre and midpoint nodes, uniform in θu and φ. Returns α
    (count,), θf (count,), and by label a pair of (count, count) arrays, α first.
    """
    alphas, tilts = (points_along(hint, count) for hint in _HINTS)
    lights, weights = light_directions(directions, "uniform")
    materials = mesh(alphas, tilts)[:, :, None, :]
    shape = (count, count, len(lights), 2)
    points = np.concatenate(
        [np.broadcast_to(materials, shape), np.broadcast_to(lights, shape)], axis=-1
    )
    truth = exact(PS.reference, points)
    errors = {}
    for label, name in COMPARED.items():
        apart = np.abs(exported_values(resolve(name), points) - truth)
        errors[label] = np.sqrt(apart**2 @ weights), apart.max(axis=-1)
    return alphas, tilts, errors


def draw_rows(count: int = 33) -> Figure:
    """Draw c₀ … c₅ over materials, a row each for the best ones and for every table."""
    alphas, tilts, rows = ps_rows(count)
    figure = Figure(figsize=(9.6, 6.4), layout="constrained")
    grid = figure.subplots(len(rows), 6, sharex=True, sharey=True)
    limits = np.ceil(np.abs(rows[BEST]).max(axis=(0, 1)) * 10) / 10
    for row, (label, values) in enumerate(rows.items()):
        for i, axes in enumerate(grid[row]):
            shown = axes.pcolormesh(
                tilts * _TILT.factor,
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
                axes.set_xlabel(f"{_TILT.short_label} / {_TILT.unit}")
                figure.colorbar(shown, ax=grid[:, i], location="bottom", aspect=12, extend="both")
            if row == 0:
                axes.set_title(f"$c_{i}$  ({_TERMS[i]})")
        grid[row, 0].set_ylabel(f"{label.replace(', ', chr(10))}\nα")
    return figure


def ps_rows(count: int) -> tuple[np.ndarray, np.ndarray, dict[str, np.ndarray]]:
    """Return c₀ … c₅ for count² materials: α (count,), θf (count,), and (count, count, 6) by label.

    The first entry is the least squares optimum of each material by itself.
    """
    published = resolve(PRINTED).require_fitted().form
    solver = published.solver
    assert isinstance(solver, Separable)
    grid = trapezoid_grid(published.axes[: published.shared], count)
    alphas, tilts = grid.nodes
    points = mesh(alphas, tilts)
    rows = {BEST: np.asarray(solver.node_fits(published, grid, "uniform").optimum)}
    rows |= {label: _rows(resolve(name), points) for label, name in TABLES.items()}
    return alphas, tilts, rows


def _rows(entry: Entry, points: np.ndarray) -> np.ndarray:
    """Evaluate c₀ … c₅ of a table at materials (…, 2): (…, 6)."""
    first = jax.vmap(jax.vmap(entry.require_fitted().first))
    return np.asarray(first(points[..., 0], points[..., 1]))
