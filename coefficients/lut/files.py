"""LUTs as files: textures for renderers, and arrays and text for other programs."""

import io
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from coefficients.lut.baking import MOST_AXES
from coefficients.lut.texels import Texel
from coefficients.lut.texture import Lut
from coefficients.textures.dds import write_dds
from coefficients.textures.exr import write_exr
from coefficients.textures.ktx2 import write_ktx2
from coefficients.textures.png import write_png16

_EVERY: tuple[Texel, ...] = ("float16", "float32", "unorm16", "unorm8")


@dataclass(frozen=True)
class Format:
    """A file format: the texels that it can hold, the usual ones first, and the most dimensions."""

    write: Callable[[Lut], bytes]
    texels: tuple[Texel, ...]
    dimensions: int


def write_lut(lut: Lut, key: str) -> bytes:
    """Return a LUT as the bytes of a file of the format `key`.

    In a texture, the first axis goes along the width, the second along the height, and the third
    along the depth. In an array or a text file, the indices are in the order of the axes. Raises
    ValueError for a format that is unknown, or that cannot hold these texels or dimensions.
    """
    require_format(key, lut.texel, len(lut.axes))
    return FORMATS[key].write(lut)


def require_format(key: str, texel: Texel | None, dimensions: int) -> Texel:
    """Return the texels to use in a format: `texel`, or the usual ones if it is None.

    Raises ValueError as `write_lut` does.
    """
    if key not in FORMATS:
        raise ValueError(f"format {key!r}: allowed are {', '.join(FORMATS)}")
    known = FORMATS[key]
    chosen = known.texels[0] if texel is None else texel
    if chosen not in known.texels:
        raise ValueError(f"{key} cannot hold {chosen}: allowed are {', '.join(known.texels)}")
    if dimensions > MOST_AXES:
        raise ValueError(f"{dimensions} arguments: a texture has at most {MOST_AXES}")
    if dimensions > known.dimensions:
        others = ", ".join(k for k, f in FORMATS.items() if f.dimensions >= dimensions)
        raise ValueError(f"{key} cannot hold {dimensions} dimensions: allowed are {others}")
    return chosen


def _image(lut: Lut) -> np.ndarray:
    """Return the stored texels with the first axis last, as textures hold them."""
    return np.ascontiguousarray(lut.stored.T)


def _exr(lut: Lut) -> bytes:
    pixel = {"float16": "<f2", "float32": "<f4"}[lut.texel]
    return write_exr({"Y": np.atleast_2d(_image(lut))}, pixel)


def _png16(lut: Lut) -> bytes:
    return write_png16(np.atleast_2d(_image(lut)))


def _npy(lut: Lut) -> bytes:
    buffer = io.BytesIO()
    np.save(buffer, lut.stored, allow_pickle=False)
    return buffer.getvalue()


def _csv(lut: Lut) -> bytes:
    """Write a line for each texel: the point of its centre, and the value that it stands for."""
    rows = np.column_stack([lut.points, lut.texels.ravel()]).tolist()
    lines = [",".join([*(axis.name for axis in lut.axes), "value"])]
    lines += [",".join(map(repr, row)) for row in rows]
    return ("\n".join(lines) + "\n").encode()


FORMATS: dict[str, Format] = {
    "exr": Format(_exr, ("float16", "float32"), 2),
    "png16": Format(_png16, ("unorm16",), 2),
    "npy": Format(_npy, ("float32", "float16", "unorm16", "unorm8"), 3),
    "csv": Format(_csv, ("float32", "float16", "unorm16", "unorm8"), 3),
    "dds": Format(lambda lut: write_dds(_image(lut), lut.texel), _EVERY, 3),
    "ktx2": Format(lambda lut: write_ktx2(_image(lut), lut.texel), _EVERY, 3),
}
EXTENSIONS = {"png16": "png"}
