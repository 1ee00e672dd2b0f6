"""Diffusion profiles of skin: sums of Gaussians, and Burley's. Lengths are in millimetres.

A radial profile R(d) is the light that leaves per area at the distance d from the point where it
enters. A linear profile ∫ R(√(x² + y²)) dy is the light per length at the distance x from a line.
"""

from dataclasses import dataclass

import jax.numpy as jnp
import numpy as np
from jax import Array

from shading.types import Scalar

# The weights of a channel add up to 1 within this.
_ROUNDING = 1e-12
# Nodes of the double exponential rule in the logarithm of the Gaussians' widths.
_REACH, _STEP = 3.8, 0.1


@dataclass(frozen=True)
class GaussianProfile:
    """A profile R(d) = Σ w exp(−d²/2v)/(2πv), for one or more channels.

    `variances` are v in mm². `weights` has a row for each channel, of as many weights; each row
    adds up to 1, so that all light that enters leaves. Raises ValueError for others.
    """

    variances: tuple[float, ...]
    weights: tuple[tuple[float, ...], ...]

    def __post_init__(self) -> None:
        """Check the variances, and that the weights add up to 1."""
        if not self.variances or not all(0 < v < np.inf for v in self.variances):
            raise ValueError(f"variances = {self.variances}: allowed are positive numbers of mm²")
        for row in self.weights:
            if len(row) != len(self.variances) or not all(w >= 0 for w in row):
                raise ValueError(
                    f"weights {row}: allowed are {len(self.variances)} numbers, none negative"
                )
            total = float(np.sum(row))
            if not abs(total - 1) < _ROUNDING:
                raise ValueError(f"weights {row} add up to {total:.6g}: allowed is 1")

    @property
    def channels(self) -> int:
        """The number of channels."""
        return len(self.weights)

    @property
    def mean_variances(self) -> tuple[float, ...]:
        """The mean variance Σ w v of each channel in mm²: half the mean squared distance."""
        return tuple(float(np.dot(row, self.variances)) for row in self.weights)

    def channel(self, index: int) -> "GaussianProfile":
        """Return one channel, without the Gaussians that have no weight in it."""
        kept = [(v, w) for v, w in zip(self.variances, self.weights[index], strict=True) if w > 0]
        return GaussianProfile(tuple(v for v, _ in kept), (tuple(w for _, w in kept),))

    def widened(self, factor: float) -> "GaussianProfile":
        """Return the profile with all variances multiplied by `factor` > 0."""
        return GaussianProfile(tuple(v * factor for v in self.variances), self.weights)


# d'Eon and Luebke, "Advanced Techniques for Realistic Real-Time Skin Rendering", GPU Gems 3 (2007),
# chapter 14, figure 14-13: variances in mm², and weights of red, green and blue.
SKIN = GaussianProfile(
    (0.0064, 0.0484, 0.187, 0.567, 1.99, 7.41),
    (
        (0.233, 0.100, 0.118, 0.113, 0.358, 0.078),
        (0.455, 0.336, 0.198, 0.007, 0.004, 0.0),
        (0.649, 0.344, 0.0, 0.007, 0.0, 0.0),
    ),
)
# Penner's and Pesce's code multiply the variances by √2.
PENNER_WIDENED = SKIN.widened(2**0.5)


def radial(profile: GaussianProfile, distance: Scalar) -> Array:
    """Return R(d) of each channel (channels,) in mm⁻², at a distance in mm."""
    v, w = jnp.asarray(profile.variances), jnp.asarray(profile.weights)
    d = jnp.asarray(distance)
    return w @ (jnp.exp(-d * d / (2 * v)) / (2 * jnp.pi * v))


def linear(profile: GaussianProfile, distance: Scalar) -> Array:
    """Return the linear profile of each channel (channels,) in mm⁻¹, at a distance in mm."""
    v, w = jnp.asarray(profile.variances), jnp.asarray(profile.weights)
    x = jnp.asarray(distance)
    return w @ (jnp.exp(-x * x / (2 * v)) / jnp.sqrt(2 * jnp.pi * v))


def burley(distance: Scalar, shape: Scalar) -> Array:
    """Return Burley's R(d) = (e^(−d/b) + e^(−d/3b))/(8πbd) in mm⁻²; `shape` is b in mm, d > 0.

    Christensen and Burley, "Approximate Reflectance Profiles for Efficient Subsurface Scattering"
    (2015), without the albedo.
    """
    d, b = jnp.asarray(distance), jnp.asarray(shape)
    return (jnp.exp(-d / b) + jnp.exp(-d / (3 * b))) / (8 * jnp.pi * b * d)


def burley_as_gaussians(shape: float, step: float = _STEP) -> GaussianProfile:
    """Return Burley's profile as a sum of Gaussians, for b = `shape` in mm.

    e^(−d/b)/(2πbd) is exactly a mean of Gaussians with the variances b²g², where g is normally
    distributed. The mean is taken by the double exponential rule of the given `step`.
    Raises ValueError for a shape that is not positive.
    """
    if not 0 < shape < np.inf:
        raise ValueError(f"shape = {shape:g} mm: allowed is a positive number")
    x = np.arange(-_REACH, _REACH + step, step)
    g = np.exp(x - np.exp(-x))
    weights = np.exp(-g * g / 2) * g * (1 + np.exp(-x))
    # What is left out has less weight than a rounding error.
    kept = (g > 1e-12) & (weights > 1e-22)
    g, weights = g[kept], weights[kept] / weights[kept].sum()
    variances = np.concatenate([(shape * g) ** 2, (3 * shape * g) ** 2])
    both = np.concatenate([weights / 4, 3 * weights / 4])
    return GaussianProfile(tuple(variances.tolist()), (tuple((both / both.sum()).tolist()),))
