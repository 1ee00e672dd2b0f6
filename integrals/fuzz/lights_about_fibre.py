"""R at many points, by a rule for lights in polar coordinates about the fibre.

Let ψ be the angle between the light u and the fibre t, and x the azimuth of u about t, from 0 where
u is lowest to π where it is highest. Then u·t = cos ψ, and

    u·n = cos(ψ + θf) + 2 sin ψ sin θf sin²(x/2),
    R = (2/π) ∫∫ P_s (u·n) sin ψ dx dψ   over all ψ and x in [0, π] with u·n > 0.

For small α, P_s changes within about α of two values of ψ only: at 0, where the light is along the
fibre, and at π/2 − θf, the cone of lights that touches the horizon. There S − T, in the equation of
λ (`shading.fuzz.lit_cone`), is zero for α = 0; like u·t it depends on ψ only. Nodes are dense at
both, so that their number grows with ln(1/α). Near the horizon P_s is like √(u·n) besides, so x is
replaced by a variable in which that root is smooth. The maps of nodes are those of Johnston and
Elliott (2005), with hyperbolic sines.
"""

import functools

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from integrals.fuzz.ps import LEAST_ALPHA
from integrals.reference import Estimate
from integrals.rules.interval import gauss_legendre
from shading.fuzz.lit_cone import scattered_fraction
from shading.sine_and_cosine import sine_and_cosine

# Nodes of each of four sections in ψ, and in x; the rule that checks has ¾ as many of both. The
# error is below 1e-11 for α ≥ 1e-3 (tests/integrals/test_lights_about_fibre.py).
_RINGS, _LIGHTS = 24, 16
# Nodes are no denser than for this α. What is smaller than this matters by less than 1e-6.
_DENSEST = 1e-4
# Widths are kept away from 0 and infinity, where the maps of the nodes have no limit.
_LEAST, _LARGEST = 1e-100, 1e3
# Roundings of a sum of all weights, in units of the last place of 1.
_ROUNDINGS = 16
# Sections in ψ: rings above the horizon, from the fibre and from the horizon on, and rings that
# cross the horizon, from their lowest and from their highest on.
_ABOVE = np.array([1.0, 1.0, -1.0, -1.0])[:, None]
# Sines of angles (lights, 4, rings)
_sines = jax.vmap(jax.vmap(jax.vmap(lambda x: sine_and_cosine(x)[0])))


def estimates_about_fibre(points: Array) -> Estimate:
    """Return R at points (n, 2) of α and θf in radians, and a bound on its error, (n,) each.

    The error is three times the difference to a rule with ¾ of the nodes in ψ and in x, plus what
    rounding may do.
    """
    alpha, theta_f = jnp.maximum(points[:, 0], LEAST_ALPHA), points[:, 1]
    # One loop after the other: within one loop, XLA would compute what a ring or a light needs
    # again for each of its uses.
    angles, ring = jax.lax.map(_rings, (alpha, theta_f))
    sines = jnp.sin(angles)
    maps = jax.lax.map(_maps, (jnp.sin(theta_f), sines, ring))
    lights = jax.lax.map(_lights, maps)
    fine, coarse = jax.lax.map(_averages, (alpha, theta_f, sines, *lights))
    error = 3 * jnp.abs(fine - coarse) + np.finfo(float).eps * (4 / alpha + _ROUNDINGS)
    return Estimate(fine, error)


def _rings(point: tuple[Array, Array]) -> tuple[Array, Array]:
    """Return angles of the rings of both rules at one point, and the weights dψ of the rings.

    The angles (3, 4, rings) have ψ, π/2 − ψ, and the height of the ring's lowest light above the
    horizon, or below it, as the sines.
    """
    alpha, theta_f = point
    s, weight = _ring_rule()
    scale, above = jnp.maximum(alpha, _DENSEST), np.pi / 2 - theta_f
    # Where rings begin and cease to cross the horizon, the part of a ring above it is like a root
    # of ψ, which a square undoes.
    stretch = jnp.arcsinh(jnp.stack([above / 2 / scale, jnp.sqrt(theta_f / scale)]))[:, None]
    power = jnp.exp(stretch * s)
    sinh, slope = (power - 1 / power) / 2, stretch * (power + 1 / power) / 2 * weight
    near, near_weight = scale * sinh[0], scale * slope[0]
    cross, cross_weight = scale * sinh[1] ** 2, 2 * scale * sinh[1] * slope[1]
    psi = jnp.stack([near, above - near, above + cross, above + 2 * theta_f - cross])
    height = jnp.stack([above - near, near, cross, 2 * theta_f - cross])
    ring = jnp.stack([near_weight, near_weight, cross_weight, cross_weight])
    return jnp.stack([psi, np.pi / 2 - psi, height]), ring


def _maps(rings: tuple[Array, Array, Array]) -> tuple[Array, ...]:
    """Return the maps of x on the rings, (4, rings) each.

    These are the least u·n of a ring and how much more it may be, the width and the stretch of the
    map, and the weight of the ring.
    """
    sin_f, (sin_psi, _, height), ring = rings
    # u·n is zero at x = ±i width above the horizon, nearly, and at x = width on it.
    rise = jnp.maximum(2 * sin_psi * sin_f, _LEAST)
    half = jnp.sqrt(height / rise)
    start = 2 * jnp.arcsin(jnp.minimum(half[2:], 1.0))
    width = jnp.clip(jnp.concatenate([2 * half[:2], start]), _LEAST, _LARGEST)
    # arcsinh above the horizon and arccosh on it
    far = np.pi / width
    spread = jnp.log(far + jnp.sqrt(jnp.maximum(far * far + _ABOVE, 0.0)))
    return _ABOVE * height, rise, width, spread, ring * sin_psi * width * spread / np.pi


def _lights(maps: tuple[Array, ...]) -> tuple[Array, Array]:
    """Return u·n of the lights of all rings, and their weights, (lights, 4, rings) each."""
    lowest, rise, width, spread, total = maps
    z, weight = _light_rule()
    power = jnp.exp(spread * z)
    inverse = _ABOVE / power
    sine = _sines(width / 4 * (power - inverse))
    cos_un = jnp.maximum(lowest + rise * sine * sine, 0.0)
    return cos_un, total * (power + inverse) * weight


def _averages(lights: tuple[Array, ...]) -> tuple[Array, Array]:
    """Return R by both rules."""
    alpha, theta_f, (sin_ut, cos_ut, _), cos_un, weights = lights
    cos_nt, sin2_nt = jnp.cos(theta_f), jnp.sin(theta_f) ** 2

    def at(cos_un, cos_ut, sin2_ut):
        return scattered_fraction(
            cos_un,
            cos_ut,
            cos_nt,
            alpha,
            sin2_ut=sin2_ut,
            sin2_nt=sin2_nt,
            least_alpha=LEAST_ALPHA,
        )

    on_all = jax.vmap(jax.vmap(jax.vmap(at)), (0, None, None))
    fraction = on_all(cos_un, cos_ut, sin_ut * sin_ut)
    on_rings = jnp.sum(fraction * cos_un * weights, axis=0)
    return jnp.sum(on_rings[:, :_RINGS]), jnp.sum(on_rings[:, _RINGS:])


@functools.cache
def _ring_rule() -> tuple[np.ndarray, np.ndarray]:
    """Return the nodes on [0, 1] of a section of rings by the rule and by its check."""
    rules = [gauss_legendre(count, 0.0, 1.0) for count in (_RINGS, 3 * _RINGS // 4)]
    nodes, weights = (np.concatenate(each) for each in zip(*rules, strict=True))
    return nodes, weights


@functools.cache
def _light_rule() -> tuple[np.ndarray, np.ndarray]:
    """Return the nodes on [0, 1] of a ring's lights, filled up with weight 0.

    They have the shape (lights, 1, rings), because loops along rings are the faster ones.
    """
    fewer = 3 * _LIGHTS // 4
    rows = []
    for rings, lights in ((_RINGS, _LIGHTS), (3 * _RINGS // 4, fewer)):
        padded = [np.pad(each, (0, _LIGHTS - lights)) for each in gauss_legendre(lights, 0.0, 1.0)]
        rows.append(np.repeat([padded], rings, axis=0))
    nodes, weights = np.concatenate(rows).transpose(1, 2, 0)[:, :, None]
    return nodes, weights
