"""Measure detail maps in BC1 on photographs: `python benchmarks/detail_maps.py`.

The materials and paintings are those of `shadefit.detail.photographs`, 256² pixels. Details and
sources are BC1; all errors are root mean squares of the composed 8-bit image, in codes. "quicktex"
encodes the source by that library at level 2 and at its best level, 18. Needs the extra `maps` and
scikit-image.
"""

import os

os.environ["JAX_ENABLE_X64"] = "1"

import numpy as np

from shadefit.detail.closed_loop import closed_loop
from shadefit.detail.compensation import errors_between
from shadefit.detail.operators import OPERATORS
from shadefit.detail.photographs import MATERIALS, PAINTINGS, painted, photograph
from shadefit.images.bc1 import blocks_of, decode_bc1, encode_bc1, packed

LEVELS = (2, 18)


def decoded(blocks: bytes, shape: tuple[int, ...]) -> np.ndarray:
    return decode_bc1(blocks, *shape[:2]) / 255


def measured(material: np.ndarray, target: np.ndarray) -> dict[str, float]:
    shape = target.shape
    detail = decoded(encode_bc1(material), shape)
    row = {}
    for level in LEVELS:
        direct = decoded(encode_bc1(target, level), shape)
        row[f"direct, quicktex {level}"] = errors_between(direct, target).rmse
        for name, operator in OPERATORS.items():
            source = operator.source(target, detail)
            coded = decoded(encode_bc1(source, level), shape)
            found = errors_between(operator.blend(coded, detail), target)
            row[f"{name}, quicktex {level}"] = found.rmse
        operator = OPERATORS["smooth-overlay"]
        coded = decoded(encode_bc1(operator.source(target, material), level), shape)
        found = errors_between(operator.blend(coded, detail), target)
        row[f"smooth-overlay, not compensated for the detail's BC1, quicktex {level}"] = found.rmse
    for name, operator in OPERATORS.items():
        blocks = packed(*closed_loop(blocks_of(target), blocks_of(detail), operator))
        found = errors_between(operator.blend(decoded(blocks, shape), detail), target)
        row[f"{name}, closed loop"] = found.rmse
    return row


def main() -> None:
    rows = {}
    for material in MATERIALS:
        picture = photograph(material)
        for painting in PAINTINGS:
            rows[material, painting] = measured(picture, painted(picture, painting))
    for method in next(iter(rows.values())):
        values = [row[method] for row in rows.values()]
        each = " ".join(f"{value:.3f}" for value in values)
        print(f"| {method} | {np.mean(values):.3f} | {each} |")
    print(", ".join(f"{material} {painting}" for material, painting in rows))


if __name__ == "__main__":
    main()
