"""Where a fit is made and judged: tensor grids with weights, and points off every grid."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from integrals import Axis

Weight = Literal["uniform", "solid-angle", "cosine"]
WEIGHTS: tuple[Weight, ...] = ("uniform", "solid-angle", "cosine")


@dataclass(frozen=True)
class Grid:
    """The tensor product of `nodes`, one array an axis; `weights` (points,) sum to one."""

    axes: tuple[Axis, ...]
    nodes: tuple[np.ndarray, ...]
    weights: np.ndarray
    spacing: Literal["uniform", "gauss-legendre"]

    @property
    def points(self) -> np.ndarray:
        """All points (points, axes), the last axis running fastest."""
        mesh = np.meshgrid(*self.nodes, indexing="ij")
        return np.stack([each.ravel() for each in mesh], axis=1)


def trapezoid_grid(axes: tuple[Axis, ...], count: int) -> Grid:
    """Give `count` uniform nodes an axis, ends included, weighted by the trapezoid rule."""
    line = np.full(count, 1 / (count - 1))
    line[[0, -1]] /= 2
    nodes = tuple(np.linspace(axis.lower, axis.upper, count) for axis in axes)
    return Grid(axes, nodes, _product([line] * len(axes)), "uniform")


def gauss_grid(axes: tuple[Axis, ...], count: int) -> Grid:
    """Give `count` Gauss–Legendre nodes an axis: weighted sums are integrals over the domain."""
    x, w = np.polynomial.legendre.leggauss(count)
    nodes = tuple(
        axis.lower + (axis.upper - axis.lower) * np.clip((x + 1) / 2, 0, 1) for axis in axes
    )
    return Grid(axes, nodes, _product([w / 2] * len(axes)), "gauss-legendre")


def measure_of_lights(theta_u: np.ndarray, weight: Weight) -> np.ndarray:
    """Give the density of a measure of lights in θu and φ, at θu."""
    sine = np.ones_like(theta_u) if weight == "uniform" else np.sin(theta_u)
    return sine * np.cos(theta_u) if weight == "cosine" else sine


def light_directions(theta_u: Axis, count: int, weight: Weight) -> tuple[np.ndarray, np.ndarray]:
    """Give lights (count², 2) as θu, φ and weights (count²,) that sum to one.

    Gauss–Legendre in θu, midpoints in φ over [0, π]: P_s is even in φ. `weight` is the measure in
    which the error is small: uniform in the angles, in solid angle, or in projected solid angle.
    """
    x, w = np.polynomial.legendre.leggauss(count)
    theta = theta_u.lower + (theta_u.upper - theta_u.lower) * (x + 1) / 2
    phi = (np.arange(count) + 0.5) * np.pi / count
    density = measure_of_lights(theta, weight)
    weights = np.repeat(w * density, count)
    return (
        np.stack([np.repeat(theta, count), np.tile(phi, count)], axis=1),
        weights / weights.sum(),
    )


def off_grid_points(axes: tuple[Axis, ...], exponent: int, seed: int) -> np.ndarray:
    """Give 2^exponent scrambled Sobol' points (points, axes) of the axes' box."""
    from scipy.stats import qmc  # noqa: PLC0415  it takes a second to import

    unit = qmc.Sobol(len(axes), rng=np.random.default_rng(seed)).random_base2(exponent)
    lower = np.array([axis.lower for axis in axes])
    upper = np.array([axis.upper for axis in axes])
    return lower + (upper - lower) * unit


def _product(lines: list[np.ndarray]) -> np.ndarray:
    weights = np.ones(1)
    for line in lines:
        weights = np.outer(weights, line).ravel()
    return weights
