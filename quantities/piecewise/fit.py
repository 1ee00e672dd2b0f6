"""Fits of a piecewise-linear NDF: its values at the knots, by the programs of `linear_fit`.

The mass, the moment ∫ D sin²θ dθ, the hidden area H of every direction, and D at any angle are
linear in the values. The fit has the mass and the moment of the target. The total variation is
½ ∫ |D − D_target| cos θ dω.
"""

from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np

from integrals.piecewise.smith import hidden_area
from integrals.rules.interval import composite_gauss
from quantities.piecewise.knots import equidistributed_knots
from quantities.piecewise.linear_fit import Rows, fitted_values
from quantities.piecewise.targets import Target
from shading.piecewise.moments import mass, moment, normalised
from shading.piecewise.ndf import Profile, density, profile

# Knots that miss the peak make the mass of the interpolated NDF too large.
MOST_MASS = 1.05
# Where D vanishes, a knot's value is of the order of what would add this mass.
LEAST_MASS = 1e-5
_NODES = 8


@dataclass(frozen=True, eq=False)
class NdfFit:
    """A fitted NDF and its errors.

    `profile` is the NDF, normalised. `mass` is c_iso, the mass of the interpolated target at these
    knots: far from 1, the knots are too few. `total_variation` is ½ ∫ |ΔD| cos θ dω, between 0 and
    1, and `masking_error` the largest |ΔG1| over `directions` polar angles from 0 to 89.99°.
    """

    target: str
    profile: Profile
    mass: float
    total_variation: float
    masking_error: float
    directions: int
    monotone: bool


def fit_ndf(
    target: Target,
    segments: int = 32,
    *,
    variable: str = "cos2",
    monotone: bool = False,
    knots: np.ndarray | None = None,
) -> NdfFit:
    """Fit an NDF of `segments` segments that is linear in `variable`, "cos2" or "angle".

    If `monotone`, D does not increase with θ. `knots` (n,), in radians, replace those that
    `equidistributed_knots` places. Raises ValueError if the knots miss the peak of the target
    (`mass` above 1.05 or below 1/1.05), and if no solution is found.
    """
    places = equidistributed_knots(target.of, segments, variable) if knots is None else knots
    start = profile(places, np.maximum(target.of(places), 0.0), variable)
    size = required_mass(start, target.name)
    rows, scale = _rows(target, start, monotone)
    fitted = normalised(profile(places, fitted_values(rows) * scale, variable))
    angles = _directions(400)
    return NdfFit(
        target.name,
        fitted,
        size,
        total_variation(fitted, target),
        masking_error(fitted, target, angles),
        len(angles),
        monotone,
    )


def required_mass(start: Profile, name: str) -> float:
    """Return the mass of an interpolated target. Raises ValueError if its knots miss the peak."""
    size = float(mass(start))
    if not 1 / MOST_MASS <= size <= MOST_MASS:
        raise ValueError(
            f"{name}: {start.knots.size - 1} segments miss the peak: the interpolated NDF has "
            f"the mass {size:.4g}, allowed are {1 / MOST_MASS:.3g} to {MOST_MASS:g}; give more"
        )
    return size


def total_variation(ndf: Profile, target: Target) -> float:
    """Return ½ ∫ |D − D_target| cos θ dω."""
    ends = np.unique(np.concatenate([np.asarray(ndf.knots), np.geomspace(1e-4, np.pi / 2, 200)]))
    at, weight = composite_gauss(ends, _NODES)
    gap = np.abs(np.asarray(density(ndf, at)) - target.of(at))
    return float(np.pi * np.sum(weight * gap * np.cos(at) * np.sin(at)))


def masking_error(ndf: Profile, target: Target, angles: np.ndarray | None = None) -> float:
    """Return the largest |ΔG1| over polar angles (k,) of directions, in radians."""
    angles = _directions(400) if angles is None else angles
    cosine = np.cos(angles)
    found = np.asarray(_areas(ndf, angles))
    exact = target.hidden_areas(angles)
    return float(np.abs(cosine / (cosine + found) - cosine / (cosine + exact)).max())


def _directions(count: int) -> np.ndarray:
    """Return polar angles, half of them equidistant, half graded towards π/2."""
    half = count // 2
    grazing = np.pi / 2 - np.geomspace(1e-3, 1, half)
    return np.sort(np.concatenate([np.linspace(0.02, np.pi / 2 - 1e-3, count - half), grazing]))


@jax.jit
def _areas(ndf: Profile, angles: jax.Array) -> jax.Array:
    return jax.lax.map(lambda theta_o: hidden_area(ndf, theta_o), jnp.asarray(angles))


@jax.jit
def _basis(ndf: Profile, at: jax.Array, angles: jax.Array) -> tuple[jax.Array, ...]:
    """Return the mass, the moment, D at angles and H at directions of each knot's hat function."""

    def hat(values):
        one = Profile(ndf.knots, values, ndf.variable)
        return mass(one), moment(one), density(one, at), _areas(one, angles)

    return jax.lax.map(hat, jnp.eye(ndf.knots.size))


def _rows(target: Target, start: Profile, monotone: bool) -> tuple[Rows, np.ndarray]:
    """Return the rows of both programs, and the scale of each knot's value."""
    knots = np.asarray(start.knots)
    at, weight = composite_gauss(knots, _NODES)
    measure = np.pi * weight * np.cos(at) * np.sin(at)
    angles = _directions(120)
    exact = target.hidden_areas(angles)
    cosine = np.cos(angles)
    masses, moments, values, areas = (
        np.asarray(each) for each in _basis(start, jnp.asarray(at), jnp.asarray(angles))
    )
    # A knot's value is of the order of D there, or where D vanishes, of what would be seen.
    scale = np.maximum(np.asarray(start.values), LEAST_MASS / (2 * masses))
    slope = cosine / (cosine + exact) ** 2
    fine, fine_weight = composite_gauss(np.linspace(0, 1, 400) ** 2 * np.pi / 2, _NODES)
    size = float(np.sum(fine_weight * target.of(fine) * np.sin(fine) ** 2))
    rows = Rows(
        np.stack([masses * scale, moments * scale / size]),
        np.ones(2),
        rises(scale) if monotone else np.zeros((0, len(knots))),
        measure[:, None] * values.T * scale,
        measure * np.asarray(target.of(at)),
        slope[:, None] * areas.T * scale,
        slope * exact,
    )
    return rows, scale


def rises(scale: np.ndarray) -> np.ndarray:
    """Return rows (n − 1, n) that are not positive if the values times `scale` do not increase."""
    return np.diff(np.diag(scale), axis=0) / np.maximum(scale[:-1], scale[1:])[:, None]
