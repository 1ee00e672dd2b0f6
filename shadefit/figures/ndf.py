"""Pictures of the piecewise-linear NDF: the paper's three figures, and rendered spheres."""

from functools import partial

import jax
import numpy as np
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from integrals.piecewise.published import masking
from integrals.piecewise.smith import smith_g1
from quantities.piecewise.fit import fit_ndf
from quantities.piecewise.targets import analytic_ndf
from shadefit.figures.picture import Picture
from shadefit.render.microfacet_sphere import (
    ggx_microfacets,
    lit_sphere,
    piecewise_microfacets,
)
from shadefit.render.srgb import to_srgb
from shading.piecewise.blend import Blend, azimuth_cdf
from shading.piecewise.moments import normalised
from shading.piecewise.ndf import density, profile, uniform_knots

# The paper's distributions are "randomly generated" and not printed. These are at the knots kπ/16,
# and are then normalised.
VALUES_X = (1.0, 0.6, 0.9, 0.3, 0.5, 0.2, 0.4, 0.1, 0.0)
VALUES_Y = (0.3, 0.9, 0.5, 0.8, 0.4, 0.6, 0.2, 0.3, 0.1)
_BLUE, _ORANGE, _GREEN, _BLACK = "#0072b2", "#d55e00", "#009e73", "#000000"
_PARTS = {"I₁": "#9ecae1", "I₂¹": "#a1d99b", "I₂²": "#fdd0a2", "hidden": "#636363"}
_TILTS = (20.0, 50.0, 80.0)
GOLD = (1.0, 0.78, 0.34)
_WIDTHS, _SEGMENTS, _SPHERE, _GAIN = (0.1, 0.4), 16, 240, 30.0


def ndf_pictures() -> dict[str, Picture]:
    """Return the pictures of the piecewise-linear NDF, by name."""
    return {
        "ndf-azimuth": Picture(
            "Figure 1 of the piecewise-linear NDF: azimuths",
            "Two isotropic distributions between the knots kπ/16, with the values 1, .6, .9, .3, "
            ".5, .2, .4, .1, 0 and .3, .9, .5, .8, .4, .6, .2, .3, .1 before they are normalised; "
            "and the part of the normals of their blend with azimuths up to φ, which oscillates "
            "about a straight line.",
            draw_azimuth,
        ),
        "ndf-domains": Picture(
            "Figure 2 of the piecewise-linear NDF: domains of integration",
            "The hemisphere of normals from above, with the direction o to the right, for three "
            "polar angles of o. The paper integrates over the three coloured parts. Only the "
            "normals of the dark part face away from o, and Λ is an integral over them alone.",
            draw_domains,
        ),
        "ndf-masking": Picture(
            "Figure 3 of the piecewise-linear NDF: masking G1",
            "G1 over the polar angle of o: of the isotropic distributions of Figure 1, and of "
            "their blend at three azimuths. The dashed lines are the paper's trapezoid rule "
            "(Eq. 28). On the right Beckmann's distribution of width 0.05 between ten uniform "
            "knots, where that rule exceeds 1 (the grey line).",
            draw_masking,
        ),
        "ndf-spheres": Picture(
            "Spheres of GGX and of the piecewise-linear NDF",
            "Spheres of gold under three lamps at infinity, with what Kulla and Conty return of "
            "multiple scattering: GGX of width 0.1 and 0.4 with its own masking and albedo, NDFs "
            "of 16 segments fitted to it, and the difference of their linear radiance, multiplied "
            "by 30 about a mid grey.",
            draw_spheres,
        ),
    }


def example() -> Blend:
    """Return the blend that the pictures show."""
    knots = uniform_knots(len(VALUES_X) - 1)
    x, y = (normalised(profile(knots, np.array(each))) for each in (VALUES_X, VALUES_Y))
    return Blend(x, y)


def draw_azimuth() -> Figure:
    """Draw both profiles and the CDF of the azimuth of their blend (Fig. 1)."""
    figure = Figure(figsize=(7.6, 3.2), layout="constrained")
    left, right = figure.subplots(1, 2)
    ndf = example()
    theta = np.linspace(0, np.pi / 2, 641)
    for each, colour, label in ((ndf.x, _BLUE, "$D_x$"), (ndf.y, _ORANGE, "$D_y$")):
        left.plot(np.degrees(theta), density(each, theta), color=colour, label=label)
        left.plot(np.degrees(each.knots), each.values, "o", color=colour, markersize=3)
    left.set(xlabel="θ (degrees)", ylabel="D per steradian", ylim=(0, None))
    left.legend()
    phi = np.linspace(0, 2 * np.pi, 361)
    right.plot(np.degrees(phi), azimuth_cdf(ndf, phi), color=_BLACK, label="cdf(φ)")
    right.plot(np.degrees(phi), phi / (2 * np.pi), color="0.6", linestyle="--", label="φ/2π")
    right.set(xlabel="φ (degrees)", ylabel="part of the normals", xticks=range(0, 361, 90))
    right.legend()
    return figure


def domains(theta_o: float, theta: np.ndarray, phi: np.ndarray) -> np.ndarray:
    """Return 0 to 3 (…) where a normal is in I₁, I₂¹, I₂², or hidden.

    `theta` and `phi` (…) are its angles in radians, φ relative to o.
    """
    seen = np.sin(theta_o) * np.sin(theta) * np.cos(phi) + np.cos(theta_o) * np.cos(theta) > 0
    return np.where(
        np.cos(phi) >= 0, 0, np.where(theta <= np.pi / 2 - theta_o, 1, np.where(seen, 2, 3))
    )


def draw_domains() -> Figure:
    """Draw the parts of the hemisphere of normals for three directions (Fig. 2)."""
    figure = Figure(figsize=(7.6, 3.2), layout="constrained")
    line = np.linspace(-1, 1, 501)
    x, y = np.meshgrid(line, line)
    radius = np.hypot(x, y)
    for axes, tilt in zip(figure.subplots(1, 3), _TILTS, strict=True):
        # The radius is the angle θ.
        part = domains(np.radians(tilt), radius * np.pi / 2, np.arctan2(y, x))
        shown = np.ma.masked_where(radius > 1, part)
        colours = ListedColormap(list(_PARTS.values()))
        axes.imshow(shown, origin="lower", extent=(-1, 1, -1, 1), cmap=colours, vmin=-0.5, vmax=3.5)
        axes.plot(tilt / 90, 0, "o", color=_ORANGE, markersize=4)
        axes.set_title(f"$θ_o$ = {tilt:g}°")
        axes.set_axis_off()
    patches = [Patch(color=colour, label=label) for label, colour in _PARTS.items()]
    figure.legend(handles=patches, loc="outside lower center", ncols=4)
    return figure


def draw_masking() -> Figure:
    """Draw G1 of isotropic and anisotropic distributions, exactly and by Eq. 28 (Fig. 3)."""
    figure = Figure(figsize=(9.2, 3.2), layout="constrained")
    isotropic, blended, narrow = figure.subplots(1, 3)
    ndf = example()
    angles = np.linspace(0.02, np.pi / 2 - 0.005, 120)
    for each, colour, label in ((ndf.x, _BLUE, "$D_x$"), (ndf.y, _ORANGE, "$D_y$")):
        _plot(isotropic, Blend(each, each), 0.0, angles, colour, label)
    for phi, colour in ((0.0, _BLUE), (45.0, _GREEN), (90.0, _ORANGE)):
        _plot(blended, ndf, np.radians(phi), angles, colour, f"φ = {phi:g}°")
    knots = uniform_knots(10)
    # Beckmann's NDF of width 0.05: exp(−tan²θ/α²)/(πα² cos⁴θ), which is 0 at π/2.
    cosine = np.cos(knots[:-1])
    values = np.exp(-((np.tan(knots[:-1]) / 0.05) ** 2)) / (np.pi * 0.05**2 * cosine**4)
    beckmann = normalised(profile(knots, np.append(values, 0.0)))
    close = np.linspace(1.2, 1.56, 120)
    _plot(narrow, Blend(beckmann, beckmann), 0.0, close, _BLUE, "Beckmann 0.05")
    narrow.axhline(1, color="0.6", linewidth=0.8)
    narrow.set(ylim=(0.8, 1.04))
    for axes in (isotropic, blended, narrow):
        axes.set(xlabel="$θ_o$ (degrees)", ylabel="G1")
        axes.legend(loc="lower left")
    return figure


def draw_spheres() -> Figure:
    """Render spheres of GGX, of fitted NDFs, and their difference."""
    figure = Figure(figsize=(7.4, 4.9), layout="constrained")
    panels = figure.subplots(2, 3)
    for line, width in zip(panels, _WIDTHS, strict=True):
        target = analytic_ndf(f"ggx:{width}")
        fitted = fit_ndf(target, _SEGMENTS).profile
        truth, own = (
            lit_sphere(each, GOLD, size=_SPHERE)
            for each in (ggx_microfacets(width), piecewise_microfacets(fitted))
        )
        gap = np.clip(0.5 + _GAIN * (own - truth), 0, 1)
        for axes, image in zip(line, (to_srgb(truth), to_srgb(own), gap), strict=True):
            axes.imshow(image, interpolation="antialiased")
            axes.set(xticks=[], yticks=[])
        line[0].set_ylabel(f"α = {width:g}")
    titles = ("GGX", f"{_SEGMENTS} segments", f"difference × {_GAIN:g}")
    for axes, title in zip(panels[0], titles, strict=True):
        axes.set_title(title)
    return figure


def _plot(axes, ndf: Blend, phi: float, angles: np.ndarray, colour: str, label: str) -> None:
    exact = jax.jit(jax.vmap(partial(smith_g1, phi_o=phi), (None, 0)))(ndf, angles)
    printed = [masking(ndf, float(each), phi, trapezoid=True) for each in angles]
    axes.plot(np.degrees(angles), exact, color=colour, label=label)
    axes.plot(np.degrees(angles), printed, color=colour, linestyle="--", linewidth=1)
