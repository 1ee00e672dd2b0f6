"""Fits of a blend of two piecewise-linear profiles to an anisotropic NDF.

A blend is any D = cos²φ f(θ) + sin²φ g(θ) with f(0) = g(0): with the masses m of both, D_x = f/m_f
and D_y = g/m_g have the weights m_f/2 and m_g/2, as Eq. 1 to 3 say. D and H are linear in the
values of f and g together, so one pair of linear programs finds both (`linear_fit`).
"""

from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np

from integrals.piecewise.smith import hidden_area, hidden_rule
from integrals.rules.interval import composite_gauss, gauss_legendre
from quantities.piecewise.fit import LEAST_MASS, required_mass, rises
from quantities.piecewise.knots import equidistributed_knots
from quantities.piecewise.linear_fit import Rows, fitted_values
from quantities.piecewise.targets import AnisotropicTarget
from shading.piecewise.blend import Blend, blend_density
from shading.piecewise.moments import mass, normalised
from shading.piecewise.ndf import Profile, density, profile

# Gauss points of a segment of θ, and of the quarter of azimuths, for the total variation.
_NODES, _AZIMUTHS = 4, 6
# Polar angles and azimuths of the directions at which G1 is fitted, and compared.
_FITTED, _COMPARED = (40, 5), (60, 9)


@dataclass(frozen=True, eq=False)
class BlendFit:
    """A fitted blend and its errors.

    `masses` are those of both slices D(θ, 0) and D(θ, π/2), interpolated at the knots and divided
    by the slices' own masses: far from 1, the knots are too few. `total_variation` is
    ½ ∫ |ΔD| cos θ dω, and `masking_error` the largest |ΔG1| over `directions` directions.
    """

    target: str
    blend: Blend
    masses: tuple[float, float]
    total_variation: float
    masking_error: float
    directions: int
    monotone: bool


def fit_blend(
    target: AnisotropicTarget,
    segments: int = 24,
    *,
    variable: str = "cos2",
    monotone: bool = False,
) -> BlendFit:
    """Fit a blend of two profiles of `segments` segments each, linear in "cos2" or "angle".

    If `monotone`, neither profile increases with θ. Raises ValueError if the knots miss the peak of
    a slice (`masses` above 1.05 or below 1/1.05), and if no solution is found.
    """
    starts, sizes = [], []
    for phi, own in ((0.0, target.widths[0]), (np.pi / 2, target.widths[1])):
        # A slice is an isotropic NDF of its own width, times a constant.
        slice_ = target.profile(own)
        knots = equidistributed_knots(slice_.of, segments, variable)
        sizes.append(
            required_mass(profile(knots, slice_.of(knots), variable), f"{target.name} at {phi:.2g}")
        )
        starts.append(profile(knots, np.maximum(target.of(knots, phi), 0.0), variable))
    rows, scale = _rows(target, starts, monotone)
    values = fitted_values(rows) * scale
    parts = np.split(values, [segments + 1])
    x, y = (
        normalised(profile(np.asarray(start.knots), part, variable))
        for start, part in zip(starts, parts, strict=True)
    )
    blend = Blend(x, y)
    directions = _directions(*_COMPARED)
    return BlendFit(
        target.name,
        blend,
        (sizes[0], sizes[1]),
        blend_variation(blend, target),
        blend_masking_error(blend, target, directions),
        len(directions),
        monotone,
    )


def blend_variation(blend: Blend, target: AnisotropicTarget) -> float:
    """Return ½ ∫ |D − D_target| cos θ dω."""
    ends = [np.asarray(blend.x.knots), np.asarray(blend.y.knots), np.geomspace(1e-4, np.pi / 2, 60)]
    theta, weight = composite_gauss(np.unique(np.concatenate(ends)), _NODES)
    phi, weights = gauss_legendre(48, 0.0, np.pi / 2)
    found = np.asarray(_values(blend, jnp.asarray(theta), jnp.asarray(phi)))
    gap = np.abs(found - target.of(theta[:, None], phi))
    return float(2 * np.sum((weight * np.cos(theta) * np.sin(theta))[:, None] * gap * weights))


@jax.jit
def _values(blend: Blend, theta: jax.Array, phi: jax.Array) -> jax.Array:
    """Return D (k, m) at polar angles (k,) and azimuths (m,)."""
    over = jax.vmap(blend_density, (None, None, 0))
    return jax.vmap(over, (None, 0, None))(blend, theta, phi)


def blend_masking_error(
    blend: Blend, target: AnisotropicTarget, directions: np.ndarray | None = None
) -> float:
    """Return the largest |ΔG1| at directions (k, 2) of polar angles and azimuths in radians."""
    directions = _directions(*_COMPARED) if directions is None else directions
    cosine = np.cos(directions[:, 0])
    found = np.asarray(_areas(blend, jnp.asarray(directions)))
    exact = target.hidden_areas(*directions.T)
    return float(np.abs(cosine / (cosine + found) - cosine / (cosine + exact)).max())


@jax.jit
def _areas(blend: Blend, directions: jax.Array) -> jax.Array:
    return jax.lax.map(lambda at: hidden_area(blend, *at), directions)


def _directions(count: int, azimuths: int) -> np.ndarray:
    """Return directions (k, 2), half of them close to the horizon, in a quarter of azimuths."""
    theta = np.concatenate(
        [
            np.linspace(0.05, np.pi / 2 - 1e-3, count - count // 2),
            np.pi / 2 - np.geomspace(1e-3, 1, count // 2),
        ]
    )
    phi = np.linspace(0, np.pi / 2, azimuths)
    return np.stack([each.ravel() for each in np.meshgrid(theta, phi, indexing="ij")], axis=1)


def _rows(
    target: AnisotropicTarget, starts: list[Profile], monotone: bool
) -> tuple[Rows, np.ndarray]:
    """Return the rows of both programs for the values of f and g, and their scales."""
    theta, weight = composite_gauss(
        np.unique(np.concatenate([np.asarray(each.knots) for each in starts])), _NODES
    )
    phi, weights = gauss_legendre(_AZIMUTHS, 0.0, np.pi / 2)
    measure = 2 * ((weight * np.cos(theta) * np.sin(theta))[:, None] * weights).ravel()
    directions = _directions(*_FITTED)
    cosine, turn = np.cos(directions[:, 0]), np.cos(2 * directions[:, 1])
    exact = target.hidden_areas(*directions.T)
    slope = cosine / (cosine + exact) ** 2
    size, scales, density_, masking, falls = [], [], [], [], []
    for sign, start in zip((1, -1), starts, strict=True):
        hats = [Profile(start.knots, each, start.variable) for each in np.eye(start.knots.size)]
        own = np.array([float(mass(each)) for each in hats]) / 2
        scale = np.maximum(np.asarray(start.values), LEAST_MASS / (2 * own))
        share = np.cos(phi) ** 2 if sign > 0 else np.sin(phi) ** 2
        values = np.asarray(_hat_values(start, jnp.asarray(theta)))
        areas = np.asarray(_hat_areas(start, jnp.asarray(directions[:, 0]), sign * turn)) / 2
        size.append(own * scale)
        scales.append(scale)
        density_.append((values[:, None, :] * share[:, None]).reshape(-1, len(scale)) * scale)
        masking.append(slope[:, None] * areas * scale)
        falls.append(rises(scale))
    peak = max(scales[0][0], scales[1][0])
    first, second = np.zeros(len(scales[0])), np.zeros(len(scales[1]))
    first[0], second[0] = scales[0][0] / peak, -scales[1][0] / peak
    fall = np.zeros((0, len(first) + len(second)))
    if monotone:
        zeros = np.zeros_like(falls[0])
        fall = np.block([[falls[0], zeros], [zeros, falls[1]]])
    rows = Rows(
        np.stack([np.concatenate(size), np.concatenate([first, second])]),
        np.array([1.0, 0.0]),
        fall,
        measure[:, None] * np.concatenate(density_, axis=1),
        measure * target.of(theta[:, None], phi).ravel(),
        np.concatenate(masking, axis=1),
        slope * exact,
    )
    return rows, np.concatenate(scales)


@jax.jit
def _hat_values(start: Profile, theta: jax.Array) -> jax.Array:
    """Return the values (k, n) of each knot's hat function."""

    def hat(values):
        return density(Profile(start.knots, values, start.variable), theta)

    return jax.vmap(hat, out_axes=1)(jnp.eye(start.knots.size))


@jax.jit
def _hat_areas(start: Profile, angles: jax.Array, turns: jax.Array) -> jax.Array:
    """Return H (d, n) of each knot's hat function times 1 ± cos 2φ; `turns` are ±cos 2φo."""

    def area(given):
        theta, weights = hidden_rule(given[0], start.knots, given[1])
        return weights @ _hat_values(start, theta)

    return jax.lax.map(area, (angles, turns))
