"""Fits of a piecewise-linear NDF: its values at the knots, by two linear programs.

The mass, the moment ∫ D sin²θ dθ, the hidden area H of every direction, and D at any angle are
linear in the values. The first program minimises the total variation ½ ∫ |D − D_target| cos θ dω
under D ≥ 0, with the mass and the moment of the target. The second minimises the largest error of
G1, to first order, while the total variation may grow to `TRADE` times its least value.
"""

from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np

from fitting.solvers.linear_programs import solve_program
from integrals.piecewise.smith import hidden_area
from quantities.piecewise.knots import equidistributed_knots
from quantities.piecewise.targets import Target, gauss_points
from shading.piecewise.moments import mass, moment, normalised
from shading.piecewise.ndf import Profile, density, profile

# By how much the second program may increase the total variation.
TRADE = 1.25
# Knots that miss the peak make the mass of the interpolated NDF too large.
MOST_MASS = 1.05
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
    size = float(mass(start))
    if not 1 / MOST_MASS <= size <= MOST_MASS:
        raise ValueError(
            f"{target.name}: {len(places) - 1} segments miss the peak: the interpolated NDF has "
            f"the mass {size:.4g}, allowed are {1 / MOST_MASS:.3g} to {MOST_MASS:g}; give more"
        )
    program = _Program(target, start, monotone)
    values = program.solve()
    fitted = normalised(profile(places, values, variable))
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


def total_variation(ndf: Profile, target: Target) -> float:
    """Return ½ ∫ |D − D_target| cos θ dω."""
    ends = np.unique(np.concatenate([np.asarray(ndf.knots), np.geomspace(1e-4, np.pi / 2, 200)]))
    at, weight = gauss_points(ends, _NODES)
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


class _Program:
    """The rows of both programs, for values that are divided by a scale of each knot."""

    def __init__(self, target: Target, start: Profile, monotone: bool):
        knots = np.asarray(start.knots)
        self.at, weight = gauss_points(knots, _NODES)
        self.measure = np.pi * weight * np.cos(self.at) * np.sin(self.at)
        angles = _directions(120)
        exact = target.hidden_areas(angles)
        cosine = np.cos(angles)
        masses, moments, values, areas = (
            np.asarray(each) for each in _basis(start, jnp.asarray(self.at), jnp.asarray(angles))
        )
        known = np.asarray(start.values)
        # A knot's value is of the order of D there, or where D vanishes, of what would be seen.
        self.scale = np.maximum(known, 1e-5 / (2 * masses))
        self.masses, self.moments = masses * self.scale, moments * self.scale
        self.values = values.T * self.scale
        self.wanted = np.asarray(target.of(self.at))
        slope = cosine / (cosine + exact) ** 2
        self.areas = slope[:, None] * areas.T * self.scale
        self.exact = slope * exact
        fine, fine_weight = gauss_points(np.linspace(0, 1, 400) ** 2 * np.pi / 2, _NODES)
        self.moment = np.sum(fine_weight * target.of(fine) * np.sin(fine) ** 2)
        self.monotone = monotone

    def solve(self) -> np.ndarray:
        """Return the values (n,) at the knots. Raises ValueError if a program is not solved."""
        knots, points = len(self.scale), len(self.at)
        size = float(self.moment)
        shape = [np.stack([self.masses, self.moments / size])]
        shape += [-shape[0]]
        ends = [np.ones(2), -np.ones(2)]
        if self.monotone:
            rise = np.diff(np.diag(self.scale), axis=0)
            shape.append(rise / np.maximum(self.scale[:-1], self.scale[1:])[:, None])
            ends.append(np.zeros(knots - 1))
        shape, ends = np.concatenate(shape), np.concatenate(ends)
        # |D − D_target| ≤ e at every point, in units of the measure's share.
        gap = self.measure[:, None] * self.values
        wanted = self.measure * self.wanted
        bound = -np.eye(points)
        matrix = np.block(
            [
                [shape, np.zeros((len(shape), points))],
                [gap, bound],
                [-gap, bound],
            ]
        )
        limit = np.concatenate([ends, wanted, -wanted])
        cost = np.concatenate([np.zeros(knots), np.ones(points)])
        first = solve_program(cost, matrix, limit, [(0, None)] * (knots + points))
        if first is None:
            raise ValueError("no NDF at these knots has the mass and the moment of the target")
        least = first[knots:].sum()
        # The largest error of G1 is t, in units of what the first solution has.
        own = np.abs(self.areas @ first[:knots] - self.exact).max()
        if own < 1e-12:
            return first[:knots] * self.scale
        rows = self.areas / own
        column = -np.ones((len(rows), 1))
        none = np.zeros((len(rows), points))
        matrix = np.block(
            [
                [matrix, np.zeros((len(matrix), 1))],
                [np.zeros((1, knots)), np.full((1, points), 1 / least), np.zeros((1, 1))],
                [rows, none, column],
                [-rows, none, column],
            ]
        )
        limit = np.concatenate([limit, [TRADE], self.exact / own, -self.exact / own])
        cost = np.concatenate([np.zeros(knots + points), [1.0]])
        second = solve_program(cost, matrix, limit, [(0, None)] * (knots + points + 1))
        best = first if second is None else second
        return np.maximum(best[:knots], 0) * self.scale
