"""Maps of lobes from image files, and mip chains to image files.

Vectors in a file are 'unsigned', v = 2 value − 1, as all PNG files need, or 'signed', v = value.
The y axis of normals points up ('opengl') or down ('directx') in the picture.
"""

from pathlib import Path
from typing import Literal, get_args

import numpy as np

from shadefit.images import (
    Image,
    image_of,
    read_image,
    require_channels,
    require_power_of_two,
    require_same_size,
    write_image,
)
from shadefit.images.image import bands
from shadefit.maps.filters import LobeMap, lobe_map

Vectors = Literal["unsigned", "signed"]
Convention = Literal["opengl", "directx"]
Widths = Literal["alpha", "perceptual"]
# Rounding to 8 bits changes a unit vector's length by up to √3/255; two colours that are no
# normals differ from 1 by much more.
LENGTH_TOLERANCE = 0.02
# A width below this is not told from 0 by 8 bits, and its lobe would be a mirror.
LEAST_WIDTH = 1e-3


def require_choice(name: str, value: str, allowed: object) -> None:
    """Raise ValueError if a value is none of those of a `Literal`."""
    if value not in get_args(allowed):
        raise ValueError(f"{name} = {value!r}: allowed are {', '.join(get_args(allowed))}")


def read_lobe_map(
    normals: Path,
    roughness: Path,
    direction: Path | None = None,
    *,
    colour_space: str | None,
    convention: Convention,
    widths: Widths,
    vectors: Vectors | None = None,
) -> LobeMap:
    """Return the map of lobes of a normal map, a roughness map and a map of directions.

    * `normals`: two channels, of which z follows, or three (a fourth is not read).
    * `roughness`: one channel, or the widths along the direction and across it in two or three.
      `widths` says whether they are α or its root, perceptual roughness.
    * `direction`: the vector of the tangent in two or three channels; None: along x.
    * `colour_space`: 'linear'. Others are refused, because none of these maps holds colours.
    * `vectors`: None: 'unsigned' for PNG and DDS files, 'signed' for EXR files.

    Raises ValueError in one line for a file that is no such map.
    """
    require_choice("convention", convention, Convention)
    require_choice("widths", widths, Widths)
    if vectors is not None:
        require_choice("vectors", vectors, Vectors)
    if colour_space == "srgb":
        raise ValueError(f"{normals}: maps of normals and roughness are linear, not srgb")
    up = 1.0 if convention == "opengl" else -1.0
    first = read_image(normals, colour_space)
    require_channels(first, 2, 3, 4)
    require_power_of_two(first)
    second = read_image(roughness, colour_space)
    require_channels(second, 1, 2, 3)
    require_same_size(first, second)
    third = None
    if direction is not None:
        third = read_image(direction, colour_space)
        require_channels(third, 2, 3)
        require_same_size(first, third)
    found, matrices = (np.empty((*first.pixels.shape[:2], 3)) for _ in range(2))
    for rows in bands(len(found)):
        found[rows] = _normals(_vectors(first, vectors, rows), first.name)
        found[rows, :, 1] *= up
        along, across = _widths(second, widths, rows)
        x, y = 1.0, 0.0
        if third is not None:
            tangent = _unit_tangents(_vectors(third, vectors, rows)[..., :2], third.name)
            x, y = tangent[..., 0], up * tangent[..., 1]
        along, across = along**2, across**2
        matrices[rows, :, 0] = along * x * x + across * y * y
        matrices[rows, :, 1] = (along - across) * x * y
        matrices[rows, :, 2] = along * y * y + across * x * x
    return lobe_map(found, matrices)


def _vectors(image: Image, vectors: Vectors | None, rows: slice) -> np.ndarray:
    """Return the vectors of some rows of an image, in float64."""
    if vectors is None:
        vectors = "signed" if image.name.lower().endswith(".exr") else "unsigned"
    values = image.pixels[rows, :, :3].astype(float)
    return values if vectors == "signed" else 2 * values - 1


def _normals(vectors: np.ndarray, name: str) -> np.ndarray:
    """Return unit normals; z of two channels is √(1 − x² − y²)."""
    if vectors.shape[-1] == 2:
        rest = 1 - np.sum(vectors * vectors, axis=-1)
        if np.min(rest) <= 0:
            raise ValueError(f"{name}: a normal with x² + y² ≥ 1: allowed are unit normals, z > 0")
        return np.concatenate([vectors, np.sqrt(rest)[..., None]], axis=-1)
    length = np.linalg.norm(vectors, axis=-1)
    worst = length.flat[np.argmax(np.abs(length - 1))]
    if abs(worst - 1) > LENGTH_TOLERANCE:
        raise ValueError(
            f"{name}: a normal of length {worst:.3g}: allowed are unit normals to within "
            f"{LENGTH_TOLERANCE}; say --vectors if they are stored in another way"
        )
    if np.min(vectors[..., 2]) <= 0:
        raise ValueError(f"{name}: a normal with z ≤ 0: allowed are normals with z > 0")
    return vectors / length[..., None]


def _unit_tangents(vectors: np.ndarray, name: str) -> np.ndarray:
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    if np.min(length) < 0.5:
        raise ValueError(
            f"{name}: a direction of length {np.min(length):.3g}: allowed are unit directions"
        )
    return vectors / length


def _widths(image: Image, widths: Widths, rows: slice) -> tuple[np.ndarray, np.ndarray]:
    values = image.pixels[rows].astype(float)
    if np.min(values) < 0 or np.max(values) > 1:
        raise ValueError(
            f"{image.name}: roughness from {np.min(values):.3g} to {np.max(values):.3g}: "
            "allowed is [0, 1]"
        )
    values = np.maximum(values if widths == "alpha" else values**2, LEAST_WIDTH)
    return values[..., 0], values[..., min(1, values.shape[-1] - 1)]


def write_chain(
    levels: list[LobeMap], folder: Path, file_format: Literal["png", "exr"], convention: Convention
) -> list[tuple[Path, Path]]:
    """Write each level as `normal-LL` and `aniso-LL` files, and return their paths.

    The channels of `aniso` are √A_xx, ½ + ½ A_xy/√(A_xx A_yy) and √A_yy. PNG files have 16 bits and
    unsigned vectors, EXR files have float32 and signed ones. The tangent frame has the y axis of
    `convention`.
    """
    folder.mkdir(parents=True, exist_ok=True)
    up = 1.0 if convention == "opengl" else -1.0
    written = []
    for number, level in enumerate(levels):
        vectors, aniso = (np.empty(level.normals.shape, np.float32) for _ in range(2))
        for rows in bands(len(vectors)):
            normals, roughness = level.normals[rows] * [1, up, 1], level.roughness[rows]
            vectors[rows] = 0.5 + 0.5 * normals if file_format == "png" else normals
            along, across = np.sqrt(roughness[..., 0]), np.sqrt(roughness[..., 2])
            correlation = up * roughness[..., 1] / (along * across)
            parts = np.stack([along, 0.5 + 0.5 * correlation, across], axis=-1)
            aniso[rows] = np.clip(parts, 0, 1)
        paths = tuple(folder / f"{name}-{number:02}.{file_format}" for name in ("normal", "aniso"))
        for path, values in zip(paths, (vectors, aniso), strict=True):
            write_image(path, image_of(values, "linear", str(path)), bits=16)
        written.append((paths[0], paths[1]))
    return written
