"""Measure what each curvature is worth for skin: `python benchmarks/curvature_errors.py [POINTS]`.

Prints the rms and the largest error of red over random points and lights of several surfaces, and
the error of the brute-force diffusion itself: against the sphere's exact light, and against fewer
nodes.
"""

import os
import sys

os.environ["JAX_ENABLE_X64"] = "1"
os.environ["OPENBLAS_NUM_THREADS"] = "1"

import numpy as np

from shadefit.curvature.comparison import METHODS, SURFACES, errors, lit, on_sphere
from shadefit.curvature.diffusion import NODES


def main(count: int = 150, seed: int = 5) -> None:
    """Print the table, a column for each surface, and the errors of the reference."""
    seen = {name: lit(surface, count, seed) for name, surface in SURFACES.items()}
    found = {name: errors(each) for name, each in seen.items()}
    print(f"{'red, rms (largest)':40s}", *(f"{name:>20s}" for name in SURFACES))
    for method in METHODS:
        red = [found[name][method][:, 0] for name in SURFACES]
        cells = [f"{np.sqrt(np.mean(e**2)):.5f} ({np.abs(e).max():.4f})" for e in red]
        print(f"{method:40s}", *(f"{cell:>20s}" for cell in cells))
    print("rms of red, green, blue divided by that along the light:")
    for method in METHODS:
        ratios = [
            np.sqrt(
                np.mean(found[name][method] ** 2, axis=0)
                / np.mean(found[name]["along the light"] ** 2, axis=0)
            )
            for name in SURFACES
        ]
        cells = [" ".join(f"{each:.3f}" for each in ratio) for ratio in ratios]
        print(f"{method:40s}", *(f"{cell:>20s}" for cell in cells))
    sphere = seen["sphere 10"]
    cosines = np.sum(sphere.normals * sphere.lights, axis=1)
    wrong = np.abs(on_sphere(10.0, cosines) - sphere.values).max()
    print(f"brute force against the exact sphere: {wrong:.1e}")
    few = min(count, 30)
    for name, surface in SURFACES.items():
        coarse = lit(surface, few, seed, NODES // 2)
        finer = lit(surface, few, seed)
        change = np.abs(coarse.values - finer.values).max()
        print(f"half of the nodes, {name}: {change:.1e}")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
