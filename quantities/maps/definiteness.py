"""The proof that a decoder's matrix is positive definite for every texel, by interval arithmetic.

The exported decoder returns Sxx, Sxy, Syy and P = αtαb. Proven on the whole cube of channels is
|(SxxSyy − Sxy²)/P² − 1| ≤ 0.9, and P ≥ a positive number. Hence the determinant is at least P²/10,
and both eigenvalues are positive, because Sxx is.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fitting.proofs.largest_error import printed
from programs.bounding.branch_and_bound import BranchAndBound
from programs.bounding.compiled import compile_kernel
from programs.bounding.largest import bound_largest
from programs.functions import Parameter, function
from programs.tracing.tracer import trace
from shading.maps.encodings import Entries, decoding

# Of (SxxSyy − Sxy²)/P² from 1. In exact arithmetic it is zero; a small claim takes more boxes.
CLAIM = 0.9
_CUBE = np.array([[0.0, 1.0]] * 3)
_CHANNELS = ("x", "y", "z")
_ENTRY = "static jet error_at(boxes *K, const jet *x) { return difference(K, x[0], x[1], x[2]); }"


@dataclass(frozen=True)
class Definiteness:
    """What is proven for all texels: Sxx ≥ `least_sxx` and P ≥ `least_product`, both positive.

    `boxes` is the number of boxes of the proof. Without a proof, `holds` is false, and `at` is a
    texel above the claim, or where the search gave up.
    """

    holds: bool
    least_sxx: float
    least_product: float
    boxes: int
    at: tuple[float, ...]


def prove_definite(
    encoding: str | Callable[..., Entries],
    *,
    threads: int = 2,
    max_boxes: int = 10**9,
) -> Definiteness:
    """Prove that a decoder returns positive definite matrices, or return where it does not.

    `encoding` is a name, or a decoder of your own that maps (x, y, z) to (Sxx, Sxy, Syy, P).
    Raises ValueError for an unknown name, and ToolchainError without a C compiler.
    """
    entries = decoding(encoding).entries if isinstance(encoding, str) else encoding
    least_sxx, least_product = (_least(entries, k) for k in (0, 3))
    code = printed("difference", _CHANNELS, lambda *texel: _from_one(*entries(*texel)))
    kernel = compile_kernel((code, _ENTRY), 3, roots_are_defined=True, fast=True)
    found = bound_largest(kernel, _CUBE, 2.0, claim=CLAIM, threads=threads, max_boxes=max_boxes)
    holds = found.upper is not None and min(least_sxx, least_product) > 0
    return Definiteness(holds, least_sxx, least_product, found.boxes, found.at)


def _from_one(sxx, sxy, syy, product):
    return (sxx * syy - sxy * sxy) / (product * product) - 1


def _least(entries: Callable[..., Entries], k: int) -> float:
    """Return a proven lower bound of one result, at least half of its least value; else -inf."""
    parameters = [Parameter(each, (0.0, 1.0)) for each in _CHANNELS]
    program = trace(function("entry", parameters, lambda *texel: entries(*texel)[k]))

    def settled(below, above, least, most):
        return below >= least / 2

    return (
        BranchAndBound(max_boxes=20_000).bound_output(program, _CUBE, (0.0, np.inf), settled).lower
    )
