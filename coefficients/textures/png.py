"""PNG files of 16-bit grey values."""

import io

import numpy as np


def write_png16(texels: np.ndarray) -> bytes:
    """Return a PNG file of texels (height, width), uint16. It has no gamma and no colour space."""
    from PIL import Image  # noqa: PLC0415  needed only here

    buffer = io.BytesIO()
    Image.fromarray(np.ascontiguousarray(texels.astype(np.uint16))).save(buffer, "png")
    return buffer.getvalue()
