"""The pictures of GGX microfacets: the missing energy, what returns it, and a white furnace."""

from collections.abc import Mapping, Sequence
from functools import partial

import jax
import numpy as np
from matplotlib.figure import Figure

from coefficients.catalogue import resolve
from coefficients.exported_code import exported_values
from integrals.microfacet import (
    average_albedo,
    directional_albedo,
    fresnel_split,
    schlick_average,
    smooth_limit,
)
from integrals.microfacet.random_walk import schlick, walk
from shadefit.figures.picture import Picture
from shadefit.render.metal import Metal, metal_sphere
from shadefit.render.srgb import to_srgb
from shading.microfacet import (
    color_by_hill,
    color_by_kulla_conty,
    color_of_walk,
    turquin_scale,
)

_ALPHAS = (1.0, 0.5, 0.2, 0.1, 0.03)
_CURVE_COLOURS = ("#56b4e9", "#0072b2", "#009e73", "#e69f00", "#d55e00")
_WALK_PATHS = 1 << 17
_NORMAL_REFLECTANCES = np.linspace(0.05, 1.0, 14)
# Material and view of each panel of the comparison with the walk.
_SURFACES = ((0.3, 0.5), (0.6, 0.9), (1.0, 0.5))
_SPHERE_ALPHAS = (0.1, 0.3, 0.6, 1.0)
# Gold in linear RGB, at normal incidence.
_GOLD = (1.0, 0.77, 0.34)
_SPHERE = 150
_FURNACE = 0.6
# The albedo of a sphere depends on μ only: it is interpolated between these, graded at the rim.
_RIM = np.linspace(0, 1, 129) ** 2
_BEST_ALBEDO, _BEST_AVERAGE = "best/ggx-directional-albedo-57", "best/ggx-average-albedo-18"


def microfacet_pictures() -> dict[str, Picture]:
    """Return the pictures of GGX microfacets, by name."""
    return {
        "ggx-dip": Picture(
            "The energy that single scattering on GGX loses",
            "The directional albedo E of GGX with F = 1, exact, for several α. Left: over the "
            "cosine μ of the view. The dip at μ ≈ α becomes narrow as α → 0, but it does not "
            "become shallow. Right: over μ/α. The dashed line is the limit e(μ/α) for α → 0. Its "
            "minimum is 0.8915, so 11 % of the energy is missing at μ = 1.106 α however smooth the "
            "surface is.",
            draw_dip,
        ),
        "ggx-colors": Picture(
            "Multiple scattering on GGX against a random walk",
            "The errors of four approximations of the albedo of a GGX metal with Schlick's "
            "reflectance, over its reflectance F0 at normal incidence. The truth is a random walk "
            f"of {_WALK_PATHS:,} paths on the microsurface; the grey bands are two of its standard "
            "errors.",
            draw_colors,
        ),
        "ggx-furnace": Picture(
            "GGX in a furnace",
            "Spheres of rough metal in an environment that is equally bright everywhere. A white "
            "metal should be invisible. First row: white, single scattering only. Second to "
            "fourth row: white, with f_ms of Kulla and Conty by the exact E and E_avg, by the "
            f"constants of MaterialX (with the average of their E), and by {_BEST_ALBEDO} and "
            f"{_BEST_AVERAGE}. Fifth and sixth row: gold, single scattering only, and with the "
            "exact f_ms and the color ⅔.",
            draw_furnace,
        ),
        "ggx-metal": Picture(
            "Rough gold",
            "Spheres of gold under a sky and three lamps, above a chequered ground, for four "
            "widths α of GGX. First row: single scattering only, which darkens rough gold. Second "
            "row: with f_ms by the exact E and E_avg and the color ⅔, which is more saturated.",
            draw_metal,
        ),
    }


def draw_dip() -> Figure:
    """Draw E over μ and over μ/α for several α, and its limit."""
    figure = Figure(figsize=(8.4, 3.6), layout="constrained")
    left, right = figure.subplots(1, 2, sharey=True)
    ratios = np.logspace(-2, 2, 161)
    limit = jax.jit(jax.vmap(lambda x: smooth_limit(x).value))(ratios)
    albedo = jax.jit(jax.vmap(lambda mu, a: directional_albedo(mu, a).value, (0, None)))
    for alpha, colour in zip(_ALPHAS, _CURVE_COLOURS, strict=True):
        # Nodes in μ/α and in μ, so that both panels have smooth curves.
        mu = np.unique(np.concatenate([np.linspace(0, 1, 101), np.minimum(ratios * alpha, 1)]))
        values = np.asarray(_padded(albedo, mu, alpha, 320))
        left.plot(mu, values, color=colour, label=f"α = {alpha:g}")
        inside = mu > 0
        right.plot(mu[inside] / alpha, values[inside], color=colour)
    right.plot(ratios, limit, color="black", linestyle="--", label="e, the limit α → 0")
    right.set(xscale="log", xlim=(ratios[0], ratios[-1]), xlabel="μ/α")
    left.set(xlim=(0, 1), ylim=(0.3, 1.01), xlabel="μ", ylabel="E")
    left.legend(loc="lower left")
    right.legend(loc="lower left")
    return figure


def _padded(function, mu: np.ndarray, alpha: float, size: int) -> np.ndarray:
    """Evaluate a compiled function at `size` points, the last of which are repeated."""
    filled = np.concatenate([mu, np.repeat(mu[-1:], size - len(mu))])
    return np.asarray(function(filled, alpha))[: len(mu)]


def draw_colors() -> Figure:
    """Draw the errors of Hill, Kulla and Conty, Turquin and `color_of_walk` against the walk."""
    figure = Figure(figsize=(9.2, 3.6), layout="constrained")
    panels = figure.subplots(1, len(_SURFACES), sharey=True)
    f0 = _NORMAL_REFLECTANCES
    fresnel = np.asarray(jax.vmap(schlick_average)(f0))
    split = jax.jit(fresnel_split)
    average = jax.jit(average_albedo)
    for panel, (alpha, mu) in zip(panels, _SURFACES, strict=True):
        view = np.array([np.sqrt(1 - mu * mu), 0.0, mu])
        truth = walk(view, alpha, reflectance=schlick(*f0), paths=_WALK_PATHS).total
        scale, offset = (float(each.value) for each in split(mu, alpha))
        returned = float(average(alpha).value)
        single, whole = f0 * scale + offset, scale + offset
        curves = {
            "none": single,
            "Kulla and Conty 2017": _added(color_by_kulla_conty, fresnel, returned, single, whole),
            "Turquin": single * np.array([turquin_scale(each, whole) for each in f0]),
            "Hill": _added(color_by_hill, fresnel, returned, single, whole),
            "color of the walk": _added(color_of_walk, fresnel, returned, single, whole),
        }
        styles = (("#999999", ":"), ("#cc79a7", "-."), ("#e69f00", "--"), ("#0072b2", (0, (5, 1))))
        for (name, values), (colour, dash) in zip(
            curves.items(), (*styles, ("black", "-")), strict=True
        ):
            panel.plot(f0, values - truth.value, color=colour, linestyle=dash, label=name)
        panel.fill_between(f0, -2 * truth.error, 2 * truth.error, color="#dddddd", linewidth=0)
        panel.set(title=f"α = {alpha:g}, μ = {mu:g}", xlabel="F0", ylim=(-0.11, 0.11), xlim=(0, 1))
    panels[0].set_ylabel("error of the albedo")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=5)
    return figure


def _added(color, fresnel: np.ndarray, average: float, single: np.ndarray, whole: float):
    each = np.array([float(color(f, average)) for f in fresnel])
    return single + each * (1 - whole)


def draw_furnace() -> Figure:
    """Draw spheres of four roughnesses in a furnace, without and with multiple scattering."""
    rows = {
        "white, single": partial(_sphere, (1.0,) * 3, False),
        "white, all": partial(_sphere, (1.0,) * 3, True),
        "MaterialX": partial(_sphere_of_table, "published/ggx-directional-albedo", None),
        "best tables": partial(_sphere_of_table, _BEST_ALBEDO, _BEST_AVERAGE),
        "gold, single": partial(_sphere, _GOLD, False),
        "gold, all": partial(_sphere, _GOLD, True),
    }
    return _spheres(
        {name: [draw(a) for a in _SPHERE_ALPHAS] for name, draw in rows.items()}, 6.4, 9.6
    )


def _spheres(rows: Mapping[str, Sequence[np.ndarray]], width: float, height: float) -> Figure:
    """Draw a named row of images, one for each α of `_SPHERE_ALPHAS`, under another."""
    figure = Figure(figsize=(width, height), layout="constrained", facecolor="white")
    panels = figure.subplots(len(rows), len(_SPHERE_ALPHAS))
    for line, (name, images) in zip(panels, rows.items(), strict=True):
        for panel, image in zip(line, images, strict=True):
            panel.imshow(image, vmin=0, vmax=1, interpolation="antialiased")
            panel.set(xticks=[], yticks=[])
            for side in ("top", "right", "bottom", "left"):
                panel.spines[side].set_visible(False)
        line[0].set_ylabel(name)
    for panel, alpha in zip(panels[0], _SPHERE_ALPHAS, strict=True):
        panel.set_title(f"α = {alpha:g}")
    return figure


def _sphere(reflectances, multiple: bool, alpha: float) -> np.ndarray:
    """Return an sRGB image (n, n, 3) of a sphere, seen from far away in a furnace."""
    scale, offset = (np.asarray(each.value) for each in _SPLIT(_RIM, alpha))
    average = float(average_albedo(alpha).value)
    channels = []
    for f0 in reflectances:
        values = f0 * scale + offset
        if multiple:
            color = float(color_of_walk(schlick_average(f0), average))
            values = values + color * (1 - scale - offset)
        channels.append(values)
    return _image(channels)


def _sphere_of_table(albedo: str, average: str | None, alpha: float) -> np.ndarray:
    """Return the image of a white sphere whose f_ms has the E and E_avg of tables.

    Without a table of E_avg, it is the average of the table's E.
    """

    def fitted(mu: np.ndarray) -> np.ndarray:
        return _values(albedo, np.stack([mu, np.full_like(mu, alpha)], axis=1))

    # In the root of μ, the dip at μ ≈ α is wide.
    roots, weights = np.polynomial.legendre.leggauss(64)
    roots = (roots + 1) / 2
    of_fitted = float(np.sum(2 * weights * roots**3 * fitted(roots**2)))
    by_table = of_fitted if average is None else float(_values(average, np.array([[alpha]]))[0])
    single = np.sum([np.asarray(each.value) for each in _SPLIT(_RIM, alpha)], axis=0)
    values = single + (1 - fitted(_RIM)) * (1 - of_fitted) / (1 - by_table)
    return _image([values] * 3)


def _values(name: str, points: np.ndarray) -> np.ndarray:
    return exported_values(resolve(name), points)


def _image(channels: Sequence[np.ndarray]) -> np.ndarray:
    """Return an sRGB image (n, n, 3); each channel has the radiances for the cosines `_RIM`.

    Unlike `to_srgb`, this keeps bright values: a white sphere must vanish.
    """
    x = (np.arange(_SPHERE) + 0.5) / _SPHERE * 2.3 - 1.15
    radius2 = x[:, None] ** 2 + x**2
    cosine = np.sqrt(np.clip(1 - radius2, 0, 1))
    inside = np.stack([np.interp(cosine, _RIM, each) for each in channels], axis=-1)
    image = _FURNACE * np.where(radius2[..., None] < 1, inside, 1.0)
    return np.where(image < 0.0031308, 12.92 * image, 1.055 * image ** (1 / 2.4) - 0.055)


def draw_metal() -> Figure:
    """Render a sphere of gold for four roughnesses, without and with multiple scattering."""

    def sphere(alpha: float, multiple: bool) -> np.ndarray:
        return to_srgb(metal_sphere(Metal(alpha, _GOLD), size=_SPHERE, multiple=multiple))

    rows = {"single": False, "all": True}
    return _spheres({k: [sphere(a, v) for a in _SPHERE_ALPHAS] for k, v in rows.items()}, 7.4, 4.1)


_SPLIT = jax.jit(jax.vmap(partial(fresnel_split, nodes=48, azimuths=96), (0, None)))
