"""Measure curvature of a large mesh: `python benchmarks/curvature_times.py [TRIANGLES]`.

Prints the CPU time and the largest memory of tensors, of their smoothing by the talk's two widths,
and of the drift, for a torus of 60 and 25 mm with uneven triangles. Prints then the error of the
smoothing: that of its cells against sums over all vertices.
"""

import os
import sys

os.environ["JAX_ENABLE_X64"] = "1"
os.environ["OPENBLAS_NUM_THREADS"] = "1"

import resource
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from shadefit.curvature import curvature
from shadefit.curvature.generators import ellipsoid, torus
from shadefit.curvature.smoothing import normal_drift, smoothed


def main(triangles: int = 1_000_000) -> None:
    """Print times, memory and errors."""
    across = max(3, round(np.sqrt(triangles / 4)))
    # Compiles the functions of large arrays, whose time does not grow with the mesh
    curvature(torus(60.0, 25.0, 100, 50))
    made = torus(60.0, 25.0, 2 * across, across, 0.2)
    print(f"{len(made.triangles)} triangles, {len(made.vertices)} vertices; {_memory()}")
    found = _timed("tensors", lambda: curvature(made))
    _timed("smoothing by 8 and 2.3 mm", lambda: smoothed(made, found))
    _timed("drift", lambda: normal_drift(made, found))
    for name, other, width in (
        ("torus 15, 6", torus(15.0, 6.0, 180, 72, 0.2), 2.3),
        ("ellipsoid 20, 10, 7", ellipsoid((20.0, 10.0, 7.0), 5), 2.3),
    ):
        raw = curvature(other)
        exact = smoothed(other, raw, [width], 1e-4).tensors
        error = np.abs(smoothed(other, raw, [width]).tensors - exact)
        print(
            f"{name}, {len(other.vertices)} vertices, {width} mm: error of the cells "
            f"{error.max():.1e}/mm, rms {np.sqrt(np.mean(error**2)):.1e}/mm, of "
            f"{np.abs(exact).max():.2f}/mm"
        )


def _timed(name: str, work: Callable[[], Any]) -> Any:
    start = time.process_time()
    result = work()
    print(f"{name}: {time.process_time() - start:.1f} s CPU; {_memory()}", flush=True)
    return result


def _memory() -> str:
    """Return the largest memory so far (ru_maxrss is in KiB on Linux)."""
    largest = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
    return f"largest memory so far {largest:.2f} GiB"


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
