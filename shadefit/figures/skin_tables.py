"""The picture of the lookup tables of skin: exact on a ring and on a sphere, and the fits."""

import functools

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from matplotlib.figure import Figure

from coefficients.catalogue import resolve
from fitting import form_values
from integrals.skin import cylinder_scattering, sphere_scattering
from quantities.skin.hyperbola_forms import MOST_CURVATURE
from shadefit.curvature.skin_light import FITS
from shadefit.figures.picture import Picture
from shadefit.render.srgb import to_srgb
from shading.skin import SKIN

_COLUMNS, _ROWS = 96, 48
# The error of a channel that is drawn as full colour
_FULL = 0.001


def skin_table_pictures() -> dict[str, Picture]:
    """Return the picture of the lookup tables of skin, by name."""
    return {
        "skin-tables": Picture(
            "Lookup tables of skin",
            "The light that skin scatters, over n·l and the curvature, for the profile of d'Eon "
            "and Luebke: exact on a ring with the linear profile, which is a cylinder, on a ring "
            "with the radial profile, which is a mistake there and scatters too little red light, "
            "and on a sphere. Below: the tables best/skin-cylinder-*-63, what the radial profile "
            "changes on a ring, and the error of the tables, 100 times as bright. Grey is no "
            "difference.",
            draw_tables,
        )
    }


def _grid() -> np.ndarray:
    """Return n·l and the curvature of the texels, (rows, columns, 2)."""
    cosine = np.linspace(-1, 1, _COLUMNS)
    curvature = np.linspace(0, MOST_CURVATURE, _ROWS)
    return np.stack(np.meshgrid(cosine, curvature), axis=-1)


@functools.partial(jax.jit, static_argnums=0)
def _exact(surface: str, points: Array) -> Array:
    def at(point):
        theta = jnp.arccos(point[0])
        if surface == "sphere":
            return sphere_scattering(SKIN, theta, point[1])
        return cylinder_scattering(SKIN, theta, point[1], radial=surface == "radial")

    return jax.lax.map(at, points, batch_size=512)


def tables_of_skin() -> dict[str, np.ndarray]:
    """Return D (rows, columns, channels): on a ring by both profiles, on a sphere, and fitted."""
    points = _grid().reshape(-1, 2)
    shape = (_ROWS, _COLUMNS, len(FITS))
    found = {
        name: np.asarray(_exact(name, points)).reshape(shape)
        for name in ("linear", "radial", "sphere")
    }
    fits = [form_values(resolve(name).require_fitted(), points) for name in FITS]
    return {**found, "fit": np.stack(fits, axis=-1).reshape(shape)}


def draw_tables() -> Figure:
    """Draw the tables as colours, and two differences around grey."""
    found = tables_of_skin()
    lost, error = found["radial"] - found["linear"], found["fit"] - found["linear"]
    panels = {
        "ring, linear profile": to_srgb(np.clip(found["linear"], 0, 1)),
        "ring, radial profile": to_srgb(np.clip(found["radial"], 0, 1)),
        "sphere": to_srgb(np.clip(found["sphere"], 0, 1)),
        "fit of the ring": to_srgb(np.clip(found["fit"], 0, 1)),
        f"radial − linear: {np.abs(lost).max():.3f} at most": _around_grey(lost, 100 * _FULL),
        f"fit − exact: {np.abs(error).max():.4f} at most": _around_grey(error, _FULL),
    }
    figure = Figure(figsize=(9.4, 4.2), layout="constrained")
    for panel, (title, image) in zip(figure.subplots(2, 3).flat, panels.items(), strict=True):
        panel.imshow(
            image,
            origin="lower",
            extent=(-1, 1, 0, MOST_CURVATURE),
            aspect="auto",
            interpolation="none",
        )
        panel.set(title=title, xticks=[-1, 0, 1], yticks=[0, 0.25, 0.5])
        panel.set(xlabel="n·l", ylabel="κ in mm⁻¹")
        panel.label_outer()
    return figure


def _around_grey(difference: np.ndarray, full: float) -> np.ndarray:
    return np.clip(0.5 + difference / (2 * full), 0, 1)
