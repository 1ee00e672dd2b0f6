"""The proof that a decoder's matrix is positive definite for every texel, by interval arithmetic.

The exported decoder returns Sxx, Sxy, Syy and P = αtαb. Proven on the whole cube of channels is
that Sxx and P are at least 4e-9 and at most 8, and that |(SxxSyy − Sxy²)/P² − 1| ≤ 0.9. Hence the
determinant is at least P²/10, and both eigenvalues are positive, because Sxx is.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jax import Array

from fitting.proofs.largest_error import printed
from programs.bounding.compiled import compile_kernel
from programs.bounding.largest import LargestValue, bound_largest
from shading.maps.encodings import Entries, decoding

# Of (SxxSyy − Sxy²)/P² from 1. In exact arithmetic it is zero; a small claim takes more boxes.
CLAIM = 0.9
# Of |1 − v/4| for v = Sxx and v = P
POSITIVE = 1 - 1e-9
_CUBE = np.array([[0.0, 1.0]] * 3)
_CHANNELS = ("x", "y", "z")
_ENTRY = "static jet error_at(boxes *K, const jet *x) { return difference(K, x[0], x[1], x[2]); }"


@dataclass(frozen=True)
class Definiteness:
    """Whether the matrix is proven to be positive definite for all texels.

    `boxes` is the number of boxes of the proof. Without a proof, `at` is a texel above a claim, or
    where the search gave up.
    """

    holds: bool
    boxes: int
    at: tuple[float, ...]


def prove_definite(
    encoding: str | Callable[..., Entries], *, threads: int = 2, max_boxes: int = 10**9
) -> Definiteness:
    """Prove that a decoder returns positive definite matrices, or return where it does not.

    `encoding` is a name, or a decoder of your own that maps (x, y, z) to (Sxx, Sxy, Syy, P).
    Raises ValueError for an unknown name, and ToolchainError without a C compiler.
    """
    entries = decoding(encoding).entries if isinstance(encoding, str) else encoding
    claims = ((_sxx_from_four, POSITIVE), (_product_from_four, POSITIVE), (_determinant, CLAIM))
    boxes, at = 0, ()
    for difference, claim in claims:
        found = _bounded(entries, difference, claim, threads, max_boxes)
        boxes, at = boxes + found.boxes, found.at
        if found.upper is None:
            return Definiteness(False, boxes, at)
    return Definiteness(True, boxes, at)


def _bounded(
    entries: Callable[..., Entries],
    difference: Callable[..., Array],
    claim: float,
    threads: int,
    max_boxes: int,
) -> LargestValue:
    code = printed("difference", _CHANNELS, lambda *texel: difference(*entries(*texel)))
    kernel = compile_kernel((code, _ENTRY), 3, roots_are_defined=True)
    return bound_largest(kernel, _CUBE, 2.0, claim=claim, threads=threads, max_boxes=max_boxes)


def _sxx_from_four(sxx, _sxy, _syy, _product):
    return 1 - sxx / 4


def _product_from_four(_sxx, _sxy, _syy, product):
    return 1 - product / 4


def _determinant(sxx, sxy, syy, product):
    return (sxx * syy - sxy * sxy) / (product * product) - 1
