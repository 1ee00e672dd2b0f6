"""Tensor grids with weights, on which forms are fitted, and Sobol' points."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from fitting.points.sobol import MOST_DIMENSIONS, scrambled_points
from integrals.reference import Axis


@dataclass(frozen=True)
class Grid:
    """A tensor grid. `nodes` has one array for each axis; `weights` (points,) sum to one."""

    axes: tuple[Axis, ...]
    nodes: tuple[np.ndarray, ...]
    weights: np.ndarray
    spacing: Literal["uniform", "gauss-legendre"]

    @property
    def points(self) -> np.ndarray:
        """All points (points, axes); the last axis changes fastest."""
        mesh = np.meshgrid(*self.nodes, indexing="ij")
        return np.stack([each.ravel() for each in mesh], axis=1)


MakeGrid = Callable[[tuple[Axis, ...], int], Grid]


def trapezoid_grid(axes: tuple[Axis, ...], count: int) -> Grid:
    """Return a grid of `count` equidistant nodes an axis, ends included.

    The weights are those of the trapezoid rule.
    """
    line = np.full(count, 1 / (count - 1))
    line[[0, -1]] /= 2
    nodes = tuple(np.linspace(axis.lower, axis.upper, count) for axis in axes)
    return Grid(axes, nodes, _product([line] * len(axes)), "uniform")


def gauss_grid(axes: tuple[Axis, ...], count: int) -> Grid:
    """Return a grid of `count` Gauss–Legendre nodes an axis, with the weights of the rule.

    A weighted sum over the grid approximates the mean over the domain.
    """
    x, w = np.polynomial.legendre.leggauss(count)
    nodes = tuple(
        axis.lower + (axis.upper - axis.lower) * np.clip((x + 1) / 2, 0, 1) for axis in axes
    )
    return Grid(axes, nodes, _product([w / 2] * len(axes)), "gauss-legendre")


def sobol_points(axes: tuple[Axis, ...], exponent: int, seed: int) -> np.ndarray:
    """Return 2^exponent scrambled Sobol' points (points, axes), uniform in the axes' box."""
    lower = np.array([axis.lower for axis in axes])
    upper = np.array([axis.upper for axis in axes])
    return lower + (upper - lower) * unit_points(len(axes), exponent, seed)


def unit_points(count: int, exponent: int, seed: int) -> np.ndarray:
    """Return 2^exponent scrambled Sobol' points (points, count) in the unit cube."""
    if count <= MOST_DIMENSIONS:
        return scrambled_points(count, exponent, seed)
    from scipy.stats import qmc  # noqa: PLC0415  its import takes a second

    return qmc.Sobol(count, rng=np.random.default_rng(seed)).random_base2(exponent)


def _product(lines: list[np.ndarray]) -> np.ndarray:
    weights = np.ones(1)
    for line in lines:
        weights = np.outer(weights, line).ravel()
    return weights
