"""The picture of skin on surfaces: a sphere, a ring and a finger by several ways, and in truth."""

import functools
from dataclasses import dataclass

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from shadefit.curvature import Mesh, curvature
from shadefit.curvature.comparison import on_sphere
from shadefit.curvature.diffusion import diffused, patch
from shadefit.curvature.generators import finger, icosphere, torus
from shadefit.curvature.raster import rasterise
from shadefit.curvature.skin_light import ALBEDO, SHADERS, skin_of
from shadefit.curvature.smoothing import DRIFT_WIDTH
from shadefit.curvature.surfaces import Ellipsoid, Finger, Surface, Torus
from shadefit.figures.picture import Picture
from shadefit.figures.style import ERRORS
from shadefit.render.srgb import to_srgb
from shading.skin.profiles import SKIN

# Pixels for a mm, the nodes of the brute force, whose error is then below 1.3e-4, and what is shown
# of the scene in mm
_SCALE, _NODES, _SHOWN = 2.25, 3, (44.0, 36.0)
_LIGHT = np.array([-0.8, 0.42, 0.3])
# The colour scale of differences ends here.
_END = 0.05


@dataclass(frozen=True)
class Placed:
    """A surface, its mesh, how it is turned (3, 3), and where its centre is in mm."""

    surface: Surface
    mesh: Mesh
    turn: np.ndarray
    centre: tuple[float, float, float]


@dataclass(frozen=True)
class Shaded:
    """Images (h, w, 3) of D by name, the last of which is the truth, and the covered pixels."""

    images: dict[str, np.ndarray]
    covered: np.ndarray


def skin_pictures() -> dict[str, Picture]:
    """Return the picture of skin on surfaces, by name."""
    return {
        "skin-surfaces": Picture(
            "Skin on a sphere, a ring and a finger",
            "A sphere of 7 mm, a torus of 10 and 4.5 mm, and a capsule of 5 mm in one light, "
            "without shadows. The truth is diffusion over each whole surface. The others are N·L; "
            "a lookup table of 128² texels with the curvature of the surface along the light, as "
            "in the talk; and fits of 20 coefficients a channel, with the effective curvature and "
            "with the equivalent cylinder, whose curvature and drift are blurred by 1.4 mm. All "
            "curvature is that of meshes. Below are the differences of red from the truth, and "
            "their rms and largest values.",
            draw_surfaces,
        )
    }


def placed() -> tuple[Placed, ...]:
    """Return the surfaces of the picture."""
    ring = Torus(10.0, 4.5)
    return (
        Placed(
            Ellipsoid((7.0, 7.0, 7.0)), icosphere(7.0, 4), _turned(0.0, 0.0), (-14.5, 10.0, 0.0)
        ),
        Placed(ring, torus(10.0, 4.5, 160, 80), _turned(0.0, -0.9), (7.0, 6.0, 0.0)),
        Placed(Finger(5.0, 14.0), finger(5.0, 14.0, 72), _turned(-0.2, 0.0), (-1.0, -10.0, 0.0)),
    )


@functools.cache
def shaded(scale: float = _SCALE, nodes: int = _NODES) -> Shaded:
    """Return the picture's images at so many pixels for a mm."""
    size = (round(_SHOWN[1] * scale), round(_SHOWN[0] * scale))
    light = _LIGHT / np.linalg.norm(_LIGHT)
    images = {name: np.zeros((*size, 3)) for name in (*SHADERS, "truth")}
    covered = np.zeros(size, bool)
    for each in placed():
        made = each.mesh
        seen = made.vertices @ each.turn.T + each.centre
        pixels = np.column_stack(
            [
                (seen[:, 0] + _SHOWN[0] / 2) * scale,
                (_SHOWN[1] / 2 - seen[:, 1]) * scale,
                seen[:, 2],
            ]
        )
        raster = rasterise(pixels, made.triangles, size)
        corners, weights = raster.corners(made.triangles)
        raw = curvature(made)
        skin = skin_of(made, raw, raw, DRIFT_WIDTH).at(corners, weights)
        own = each.turn.T @ light
        for name, shader in SHADERS.items():
            images[name][raster.covered] = shader(skin, own)
        points = np.einsum("pk,pki->pi", weights, made.vertices[corners])
        images["truth"][raster.covered] = _truth(each.surface, points, own, nodes)
        covered |= raster.covered
    return Shaded(images, covered)


def draw_surfaces() -> Figure:
    """Draw the surfaces by each way and in truth, and below them the differences of red."""
    found = shaded()
    truth = found.images["truth"]
    figure = Figure(figsize=(10.4, 3.9))
    across, tall = 1 / len(found.images), 0.43
    for column, (name, image) in enumerate(found.images.items()):
        upper = figure.add_axes((column * across, 0.5, across * 0.97, tall))
        picture = np.where(found.covered[..., None], to_srgb(ALBEDO * image), 1.0)
        upper.imshow(picture, interpolation="none")
        upper.set_title(name)
        if name == "truth":
            continue
        lower = figure.add_axes((column * across, 0.0, across * 0.97, tall))
        off = np.where(found.covered, (image - truth)[..., 0], np.nan)
        lower.imshow(off, cmap=ERRORS, vmin=-_END, vmax=_END, interpolation="none")
        inside = off[found.covered]
        rms, largest = np.sqrt(np.mean(inside**2)), np.abs(inside).max()
        lower.set_title(f"rms {rms:.4f}, largest {largest:.3f}", fontsize=8, pad=2)
    for axes in figure.axes:
        axes.set(xticks=[], yticks=[])
        axes.spines[:].set_visible(False)
    bar = figure.add_axes((1 - 0.8 * across, 0.06, 0.012, 0.3))
    scale = ScalarMappable(Normalize(-_END, _END), ERRORS)
    label = "red, minus the truth"
    figure.colorbar(scale, cax=bar, extend="both", ticks=(-_END, 0, _END), label=label)
    return figure


def _truth(surface: Surface, points: np.ndarray, light: np.ndarray, nodes: int) -> np.ndarray:
    """Return D (n, 3) at points of a surface: by the exact integral on a sphere, else by nodes."""
    if isinstance(surface, Ellipsoid) and len(set(surface.axes)) == 1:
        radius = surface.axes[0]
        cosines = points @ light / np.linalg.norm(points, axis=1)
        return on_sphere(radius, cosines)
    return np.array([diffused(patch(surface, p, nodes), p, light, SKIN) for p in points])


def _turned(about_z: float, about_x: float) -> np.ndarray:
    """Return the rotation (3, 3) about x and then about z, in radians."""
    c, s = np.cos(about_x), np.sin(about_x)
    tilt = np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
    c, s = np.cos(about_z), np.sin(about_z)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ tilt
