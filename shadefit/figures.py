"""`shadefit figures`: P_s exact, published and refitted over the hemisphere of lights."""

import io
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from coefficients.catalogue import form_of, load
from coefficients.table import write_whole_bytes
from integrals import PS
from shadefit.refit import require_writable

# Materials (α, θf in degrees) that are drawn, one row each.
MATERIALS = ((0.2, 23.0), (0.35, 45.0), (0.35, 80.0))
FORMATS = ("png", "svg")
_PIXELS = 201


def run(out: Path) -> None:
    """Draw every figure into a folder, as PNG and SVG; the same tables give the same bytes."""
    require_writable(out)
    for extension, data in draw_ps().items():
        path = out / f"ps.{extension}"
        write_whole_bytes(path, data)
        print(path)


def draw_ps() -> dict[str, bytes]:
    """Draw P_s and the errors of its tables as seen from above; returns the files by extension."""
    import matplotlib as mpl  # noqa: PLC0415

    mpl.use("Agg")
    mpl.rcParams.update({"svg.hashsalt": "shadefit", "font.size": 9, "axes.titlesize": 10})
    from matplotlib import pyplot as plt  # noqa: PLC0415

    tables = {"published": form_of(load("published/ps")), "refitted": form_of(load("ps"))}
    titles = ["exact", *tables, *(f"{name} − exact" for name in tables)]
    figure, axes = plt.subplots(
        len(MATERIALS), len(titles), figsize=(10.4, 6.4), layout="constrained"
    )
    line = np.linspace(-1, 1, _PIXELS)
    x, y = np.meshgrid(line, line)
    inside = np.hypot(x, y) <= 1
    theta, phi = np.arcsin(np.minimum(np.hypot(x, y), 1)), np.arctan2(y, x)
    values = differences = None
    for row, (alpha, degrees) in zip(axes, MATERIALS, strict=True):
        theta_f = np.radians(degrees)
        exact = _map(PS.value, alpha, theta_f, theta, phi)
        fitted = [_map(form, alpha, theta_f, theta, phi) for form in tables.values()]
        for axis, image in zip(row[:3], [exact, *fitted], strict=True):
            values = _show(axis, np.where(inside, image, np.nan), "viridis", 0, 1)
        for axis, image in zip(row[3:], fitted, strict=True):
            shown = np.where(inside, image - exact, np.nan)
            differences = _show(axis, shown, "PuOr", -0.1, 0.1)
        row[0].set_ylabel(f"α = {alpha:g}, θf = {degrees:g}°")
    for axis, title in zip(axes[0], titles, strict=True):
        axis.set_title(title)
    assert values is not None
    assert differences is not None
    below: dict[str, Any] = {"location": "bottom", "shrink": 0.6, "aspect": 30, "pad": 0.02}
    figure.colorbar(values, ax=axes[:, :3], label="fraction scattered to the base, P_s", **below)
    figure.colorbar(differences, ax=axes[:, 3:], label="error of P_s", extend="both", **below)
    files = {}
    for extension in FORMATS:
        buffer = io.BytesIO()
        metadata = {"Date": None} if extension == "svg" else {"Software": None}
        figure.savefig(buffer, format=extension, dpi=110, metadata=metadata)
        files[extension] = buffer.getvalue()
    plt.close(figure)
    return files


def _map(function, alpha: float, theta_f: float, theta: np.ndarray, phi: np.ndarray) -> np.ndarray:
    each = jax.jit(jax.vmap(lambda t, p: function(alpha, theta_f, t, p)))
    return np.asarray(each(jnp.asarray(theta.ravel()), jnp.asarray(phi.ravel()))).reshape(phi.shape)


def _show(axis, image: np.ndarray, colours: str, low: float, high: float):
    axis.set(xticks=[], yticks=[], aspect="equal")
    axis.spines[:].set_visible(False)
    extent = (-1, 1, -1, 1)
    return axis.imshow(image, origin="lower", extent=extent, cmap=colours, vmin=low, vmax=high)
