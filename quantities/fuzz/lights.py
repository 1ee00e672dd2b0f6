"""Directions of light: their cosines with the normal and the fibre, and rules over all lights."""

import jax.numpy as jnp
import numpy as np
from jax import Array

from integrals.fuzz.ps import MEASURES, THETA_U
from shading import direction_cosines
from shading.types import Scalar


def cosines_of_light(
    _: Scalar, theta_f: Scalar, theta_u: Scalar, phi: Scalar
) -> tuple[Array, Array]:
    """Return u·n and u·t at a point (α, θf, θu, φ) of P_s."""
    return direction_cosines(theta_f, theta_u, jnp.cos(phi))


def cosines_at(points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return u·n, u·t and n·t, (n,) each, at points (n, 4) of (α, θf, θu, φ), in NumPy."""
    _, theta_f, theta_u, phi = points.T
    cos_un, cos_nt = np.cos(theta_u), np.cos(theta_f)
    cos_ut = np.sin(theta_u) * np.cos(phi) * np.sin(theta_f) + cos_un * cos_nt
    return cos_un, cos_ut, cos_nt


def light_directions(count: int, measure: str) -> tuple[np.ndarray, np.ndarray]:
    """Return lights (count², 2), as θu and φ in radians, and weights (count²,) that sum to one.

    The nodes are those of Gauss–Legendre in θu, and midpoints of φ in [0, π], because P_s is even
    in φ. `measure` names the weight of a direction in squared errors: 'uniform' in the angles, by
    'solid-angle', or by 'cosine', that is, by projected solid angle.
    """
    x, w = np.polynomial.legendre.leggauss(count)
    theta = THETA_U.lower + (THETA_U.upper - THETA_U.lower) * (x + 1) / 2
    phi = (np.arange(count) + 0.5) * np.pi / count
    at_angles = np.stack([np.zeros(count), np.zeros(count), theta, np.zeros(count)], axis=1)
    density = MEASURES[measure].density(at_angles)
    weights = np.repeat(w * density, count)
    lights = np.stack([np.repeat(theta, count), np.tile(phi, count)], axis=1)
    return lights, weights / weights.sum()
