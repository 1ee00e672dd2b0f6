"""Pictures of the samplers of visible normals: caps and the horizon, rejections, variances."""

import jax
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from integrals.microfacet.sampling_variance import moments, variances
from shadefit.figures.picture import Picture
from shading.directions import direction
from shading.microfacet.horizon import horizon_height
from shading.microfacet.reflection_cone import components
from shading.microfacet.sampling import cap_bound, projected_areas, stretched_length

# αx, αy, and the view's θ and φ in degrees: our choice, because the paper does not state its own.
_CAPS = (
    (0.5, 0.5, 60, 0),
    (0.9, 0.9, 60, 0),
    (0.2, 0.2, 80, 0),
    (0.2, 0.8, 5, 0),
    (1.0, 0.3, 60, 40),
    (0.3, 1.0, 60, 0),
)
# The same for the table of rejections and variances
_TABLE = (
    *((0.1, 0.1, theta, 0) for theta in (0, 60, 85)),
    (0.25, 0.25, 60, 0),
    *((0.5, 0.5, theta, 0) for theta in (0, 30, 60, 85)),
    (0.75, 0.75, 60, 0),
    *((1.0, 1.0, theta, 0) for theta in (0, 60, 89)),
    (0.2, 0.8, 5, 0),
    (1.0, 0.3, 60, 40),
)
_LONGITUDES = 241
# Of each sampler: label, colour, marker, dashes. The colours of the caps are those of the paper.
_STYLES = (
    ("all visible normals", "#009e73", "s", (0, (5, 2))),
    ("bounded cap", "#c0272d", "D", "-"),
    ("upper normals only", "#e69f00", "o", "-"),
)


def sampling_pictures() -> dict[str, Picture]:
    """Return the pictures of the samplers, by name."""
    return {
        "horizon-caps": Picture(
            "Spherical caps and the horizon",
            "What samplers of visible GGX normals draw from, after Figure 1 of the supplement of "
            "Tokuyoshi and Eto (2024), with parameters of our own. In the space where GGX is a "
            "sphere, cap samplers draw reflections uniformly above a height δ_z: above the green "
            "line all visible normals, above the red line those of the bounded cap. The orange "
            "line is the horizon, over the longitude of the reflection; what is below it is "
            "rejected. The red line touches it for isotropic surfaces (first row). The sampler of "
            "upper normals draws above the orange line only. The fractions are those that are "
            "rejected.",
            draw_caps,
        ),
        "sampling-variance": Picture(
            "Rejections and variances of samplers",
            "For a view at θ and φ, and roughnesses αx and αy: the fraction of the reflections "
            "below the horizon, and the variance of one sample of the albedo E with F = 1, for "
            "three densities. The sampler of upper normals rejects none. Where the bounded cap "
            "rejects none, both are the same.",
            draw_variances,
        ),
    }


def draw_caps() -> Figure:
    """Draw the heights of both caps and of the horizon over the longitude of the reflection."""
    figure = Figure(figsize=(9.6, 5.2), layout="constrained")
    panels = figure.subplots(2, 3, sharex=True, sharey=True)
    for axes, (alpha_x, alpha_y, theta, phi) in zip(panels.flat, _CAPS, strict=True):
        _draw_cap(axes, np.array([alpha_x, alpha_y]), theta, phi)
    for axes in panels[1]:
        axes.set_xlabel("longitude of the reflection / °")
    for axes in panels[:, 0]:
        axes.set_ylabel("height $δ_z$")
    panels[0, 0].set(
        xlim=(-180, 180), xticks=(-180, -90, 0, 90, 180), ylim=(-1.05, 0.2), yticks=(-1, -0.5, 0)
    )
    figure.legend(*panels[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure


def _draw_cap(axes: Axes, alphas: np.ndarray, theta: int, phi: int) -> None:
    view, degrees = _view(theta, phi), np.linspace(-180, 180, _LONGITUDES)
    horizon = jax.vmap(horizon_height, (None, None, 0))(view, alphas, np.radians(degrees))
    given, areas = components(view, alphas), projected_areas(view, alphas)
    whole = -float(given[2] / stretched_length(*given))
    heights = (whole, float(cap_bound(*given)) * whole)
    labels = ("all visible normals", "bounded cap", "horizon")
    for (_, colour, _, dashes), height, label in zip(_STYLES, heights, labels, strict=False):
        axes.axhline(height, color=colour, linestyle=dashes, label=label)
    axes.plot(degrees, horizon, color=_STYLES[2][1], label=labels[2], linewidth=2.2, zorder=1)
    axes.fill_between(degrees, heights[1], horizon, color=_STYLES[2][1], alpha=0.15, linewidth=0)
    lost = [1 - float(areas.upper / each) for each in areas[:2]]
    axes.set_title(f"{_roughness(*alphas)}, θ = {theta}°" + (f", φ = {phi}°" if phi else ""))
    text = f"rejected: {100 * lost[0]:.1f} %, bounded {100 * max(lost[1], 0.0):.1f} %"
    axes.text(0.5, 0.98, text, transform=axes.transAxes, ha="center", va="top", fontsize=8)


def draw_variances() -> Figure:
    """Draw the rejected fraction and the variance of one sample, by sampler, for all settings."""
    figure = Figure(figsize=(9.6, 5.0), layout="constrained")
    left, right = figure.subplots(1, 2, sharey=True, width_ratios=(4, 5))
    rejected, found = _measured()
    rows = np.arange(len(_TABLE))
    for k, (label, colour, marker, _) in enumerate(_STYLES):
        style = {"color": colour, "marker": marker, "linestyle": "none", "label": label}
        hollow = {"markerfacecolor": "none"} if k < 2 else {"markersize": 5}
        left.plot(100 * rejected[:, k], rows, **style, **hollow, clip_on=False)
        right.plot(found[:, k], rows, **style, **hollow)
    for row in rows:
        right.plot(found[row, [0, 2]], [row, row], color="0.85", linewidth=1, zorder=0)
        gain = found[row, 1] / found[row, 2]
        text = f"{gain:.1f}×" if gain > 1.005 else "="
        right.text(1.02, row, text, transform=right.get_yaxis_transform(), va="center", fontsize=8)
    head = right.get_yaxis_transform()
    right.text(1.02, -0.9, "bounded / upper", transform=head, va="center", ha="center", fontsize=8)
    left.set(xlabel="rejected / %", xlim=(0, None), ylim=(len(rows) - 0.5, -0.5))
    left.set_yticks(rows, [_setting(*each) for each in _TABLE])
    right.set(xlabel="variance of one sample of E", xscale="log")
    right.tick_params(axis="y", length=0)
    figure.legend(*left.get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure


def _measured() -> tuple[np.ndarray, np.ndarray]:
    """Return the rejected fractions and the variances, (settings, samplers) each."""
    one = jax.jit(_row)
    rows = [one(_view(theta, phi), np.array([x, y])) for x, y, theta, phi in _TABLE]
    rejected, found = (np.array([row[k] for row in rows]) for k in (0, 1))
    return np.maximum(rejected, 0.0), found


def _row(view, alphas):
    areas = projected_areas(view, alphas)
    rejected = [1 - areas.upper / each for each in areas]
    return rejected, list(variances(view, alphas, moments(view, alphas)))


def _view(theta: int, phi: int) -> np.ndarray:
    return np.asarray(direction(*np.radians([theta, phi])))


def _roughness(alpha_x: float, alpha_y: float) -> str:
    if alpha_x == alpha_y:
        return f"α = {alpha_x:g}"
    return f"αx = {alpha_x:g}, αy = {alpha_y:g}"


def _setting(alpha_x: float, alpha_y: float, theta: int, phi: int) -> str:
    return f"{_roughness(alpha_x, alpha_y)},  {theta}°" + (f", φ = {phi}°" if phi else "")
