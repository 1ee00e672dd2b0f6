"""E_lit, the integral of the phase function of a fibre over the lights above the horizon.

E_lit(v; α, θf) = ∫_Ω p_F(u, v) dω_u, where Ω is the upper hemisphere. In uniform light it is the
light that one scattering event sends to the view v. The ambient model of the talk uses
1 − P_s(v) = ∫_Ω p_F(v, u) dω_u instead, which differs because p_F is not symmetric. No closed form
is known. docs/ambient-light.md derives the integral over one variable that is used here.
"""

from dataclasses import replace
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from integrals.fuzz.ps import ALPHA, LEAST_ALPHA, PHI, THETA_F, THETA_U
from integrals.fuzz.sggx import hemisphere_integral
from integrals.monte_carlo import Sequence, indicator, mean_estimate, unit_points
from integrals.reference import Estimate, Reference, leg
from integrals.rules.interval import checked_rule
from integrals.sampling import Sampling
from shading import (
    direction,
    fiber_direction,
    fiber_normal_distribution,
    fiber_projected_area,
    fiber_root,
    reflect,
    sin2_between,
    visible_normal,
)

THETA_V = replace(THETA_U, name="theta_v", symbol="θv", meaning="polar angle of the view")
PHI_V = replace(PHI, meaning="azimuth of the view relative to the fibre")
AXES = (ALPHA, THETA_F, THETA_V, PHI_V)

# The double exponential rule ends within 1e-27 of the ends of a segment. For α = 1e-9 the integrand
# changes within α² = 1e-18 of them.
_REACH = 3.7
# The least distance from the fibre's mirror image of v, in u·t. It prevents 0/0 in empty segments.
_LEAST_GAP = 1e-60


class _View(NamedTuple):
    """What the integrand needs to know about a view and a fibre, scalars.

    `a` is v·t and `sin2` is 1 − a². `b` is n·t and `rim` is √(1 − b²). `middle` is the azimuth ψ_n
    about t from v to n. `alpha2` is α² and `kappa` is κ = 1 − α².
    """

    a: Array
    sin2: Array
    b: Array
    rim: Array
    middle: Array
    alpha2: Array
    kappa: Array


class _Place(NamedTuple):
    """A value s = u·t by its differences from −a, −1, 1 and ±√(1 − b²), each exact near its zero.

    `gap` is s + a, `below` is 1 + s, `above` is 1 − s, `left` is s + √(1 − b²) and `right` is
    √(1 − b²) − s.
    """

    s: Array
    gap: Array
    below: Array
    above: Array
    left: Array
    right: Array


@leg(*AXES)
def quadrature(alpha, theta_f, theta_v, phi, *, nodes: int = 256) -> Estimate:
    """Integrate over s = u·t, with the azimuth of u about t in closed form.

    The range of s is split where the integrand is singular or changes within α: at s = −v·t and at
    s = ±sin θf. Each of the four segments has a double exponential rule of about `nodes` nodes.
    The error combines three times the difference to half as many nodes, rounding, and what both
    rules may miss. For α ≥ 0.15 it is below 1e-8, and for most points below 1e-13.
    """
    view = _view(alpha, theta_f, theta_v, phi)
    ends = jnp.sort(
        jnp.stack([-jnp.ones(()), jnp.ones(()), -view.rim, view.rim, jnp.clip(-view.a, -1, 1)])
    )
    x, weights = _double_exponential(nodes)
    rows = jax.vmap(lambda low, high: _row(view, low, high, x))(ends[:-1], ends[1:])
    values = rows * weights
    fine, coarse = jnp.sum(values), 2 * jnp.sum(values[:, ::2])
    # The nodes of a segment are even in the logarithm of the distance to its ends, so the rate of
    # convergence falls with ln(1/α) only. Two rules may agree by chance, so a term of rate 0.6 is
    # added. It is measured, not proven: with it, no stated error was too small for α ≥ 1e-9.
    hidden = jnp.minimum(1.0, 2 * jnp.exp(-0.6 * nodes / (1 - jnp.log(alpha))))
    rounding = 16 * np.finfo(float).eps / alpha
    return Estimate(fine, 3 * jnp.abs(fine - coarse) + hidden + rounding)


def _double_exponential(nodes: int) -> tuple[tuple[np.ndarray, np.ndarray], np.ndarray]:
    """Return nodes in [0, 1] as distances from both ends, and weights, (about `nodes`,) each."""
    half = nodes // 2
    step = _REACH / half
    z = np.arange(-half, half + 1) * step
    w = np.pi / 2 * np.sinh(z)
    lower, upper = 1 / (1 + np.exp(-2 * w)), 1 / (1 + np.exp(2 * w))
    weights = step * np.pi * np.cosh(z) * lower * upper
    return (lower, upper), weights


def _view(alpha: Array, theta_f: Array, theta_v: Array, phi: Array) -> _View:
    alpha = jnp.maximum(alpha, LEAST_ALPHA)
    a = direction(theta_v, phi) @ fiber_direction(theta_f)
    # The azimuth about t, from the part of v at right angles to t. It has no limit at v = ±t, but
    # nothing depends on it there.
    side = jnp.sin(theta_v) * jnp.sin(phi)
    ahead = jnp.sin(theta_f) * jnp.cos(theta_v) - jnp.cos(theta_f) * jnp.sin(theta_v) * jnp.cos(phi)
    none = (side == 0) & (ahead == 0)
    return _View(
        a=a,
        sin2=sin2_between(theta_v, theta_f, phi),
        b=jnp.cos(theta_f),
        rim=jnp.sin(theta_f),
        middle=jnp.arctan2(side, jnp.where(none, 1.0, ahead)),
        alpha2=alpha * alpha,
        kappa=(1 - alpha) * (1 + alpha),
    )


def _row(view: _View, low: Array, high: Array, x: tuple[np.ndarray, np.ndarray]) -> Array:
    """Return the integrand times the width of the segment from `low` to `high`, at nodes `x`."""
    width = high - low

    def beyond(end):
        """Return the differences s − end, from the nearer end of the segment."""
        near_low = (low - end) + width * x[0]
        return jnp.where(x[0] < x[1], near_low, (high - end) - width * x[1])

    place = _Place(
        s=beyond(0.0),
        gap=beyond(-view.a),
        below=beyond(-1.0),
        above=-beyond(1.0),
        left=beyond(-view.rim),
        right=-beyond(view.rim),
    )
    return width * jax.vmap(lambda each: _over_azimuth(view, each))(place)


def _over_azimuth(view: _View, place: _Place) -> Array:
    """Return ∫ p_F dψ at s = u·t over the azimuths ψ about t that are above the horizon.

    With u·v = sa + √((1−s²)(1−a²)) cos ψ the phase function is (1 − K/Y)²/(4πα √(1−κs²)) with
    Y = P + Q cos ψ. The integrals of 1/Y and 1/Y² are elementary.
    """
    # notation: as in docs/ambient-light.md, with big_k = K, big_p = P, big_q = Q, gap = |s + a|,
    # turn = 1 + sa, r = √(P² − Q²), k = K/r, least = P − Q, and ratio = q = Q/(P + r). These forms
    # of r, P − Q and 1 − q have no cancellation.
    alpha2, kappa = view.alpha2, view.kappa
    sign = jnp.where(place.gap < 0, -1.0, 1.0)
    gap = jnp.maximum(sign * place.gap, _LEAST_GAP)
    sin2_s = place.below * place.above
    turn = jnp.maximum(view.sin2 + sign * view.a * gap, 0.0)
    sines = _root(sin2_s) * _root(view.sin2)
    big_k = kappa * gap * gap
    big_p, big_q = 2 * alpha2 * turn + big_k, 2 * alpha2 * sines
    slope = jnp.sqrt(kappa * big_k + 4 * alpha2 * (alpha2 + kappa * turn))
    r, k = gap * slope, kappa * gap / slope
    least = gap * gap * (kappa + 2 * alpha2 / (turn + sines + _LEAST_GAP))
    ratio, rest = big_q / (big_p + r), (least + r) / (big_p + r)

    def antiderivative(psi):
        sine, cos2 = jnp.sin(psi), 2 * jnp.cos(psi / 2) ** 2
        angle = psi - 2 * jnp.arctan2(ratio * sine, rest + ratio * cos2)
        second = big_p * (angle / r) - big_q * sine / (least + big_q * cos2)
        return psi - 2 * k * angle + k * k * second

    half = _half_width(view, place)
    ends = antiderivative(view.middle + half) - antiderivative(view.middle - half)
    return ends / (4 * jnp.pi * jnp.sqrt(alpha2 * (alpha2 + kappa * sin2_s)))


def _half_width(view: _View, place: _Place) -> Array:
    """Return ψ_m: lights with this s are above the horizon if |ψ − ψ_n| < ψ_m."""
    square = place.left * place.right
    crosses = square > 0
    some = jnp.arctan2(jnp.sqrt(jnp.where(crosses, square, 1.0)), -place.s * view.b)
    return jnp.where(crosses, some, jnp.where(place.s > 0, jnp.pi, 0.0))


def _root(square: Array) -> Array:
    """Return the square root, with a finite derivative at zero and for what rounding made less."""
    positive = square > 0
    return jnp.where(positive, jnp.sqrt(jnp.where(positive, square, 1.0)), 0.0)


@leg(*AXES)
def hemisphere(alpha, theta_f, theta_v, phi, *, nodes: int = 256) -> Estimate:
    """Integrate the definition by a product rule with `nodes`² points. It checks `quadrature`.

    The rule is that of P_s, over the half vector, with 1/σ_F(u) in the integrand.
    """
    fiber, view = fiber_direction(theta_f), direction(theta_v, phi)

    def density(h):
        area = fiber_projected_area(reflect(view, h) @ fiber, alpha)
        return fiber_normal_distribution(h @ fiber, alpha) / area

    estimate = checked_rule(
        lambda count: hemisphere_integral(density, 1.0, theta_v, phi, count), nodes, 1e-14
    )
    # Two rules that both miss the ridge of D, or that of 1/σ_F(u), agree on a wrong value.
    resolution = nodes * alpha
    hidden = jnp.minimum(1.0, 2 * (1 + resolution) * jnp.exp(-0.6 * resolution))
    rounding = 16 * np.finfo(float).eps / alpha**2
    return Estimate(estimate.value, estimate.error + hidden + rounding)


@leg(*AXES)
def monte_carlo(
    alpha,
    theta_f,
    theta_v,
    phi,
    *,
    samples: int = 1 << 16,
    sequence: Sequence = "random",
    seed: int = 0,
) -> Estimate:
    """Draw normals visible from v, reflect v to u, and average σ_F(v)/σ_F(u) of the u above.

    Not differentiable.
    """
    fiber, view = fiber_direction(theta_f), direction(theta_v, phi)
    root = fiber_root(fiber, alpha)
    area_v = fiber_projected_area(view @ fiber, alpha)
    points = unit_points(samples, 2, sequence, seed)

    def arrives(point):
        light = reflect(view, visible_normal(root, view, point))
        return indicator(light[2]) * area_v / fiber_projected_area(light @ fiber, alpha)

    return mean_estimate(jax.vmap(jax.vmap(arrives))(points))


E_LIT = Reference(
    name="lit",
    symbol="E_lit",
    meaning="integral of the phase function over the lights above the horizon",
    definition="∫_Ω p_F(u, v) dω_u",
    axes=AXES,
    sampling=Sampling(fitted=13, checked=15, judged=17),
    quadrature=quadrature,
    monte_carlo=monte_carlo,
    # It may be a little above one (docs/ambient-light.md).
    codomain=(0.0, 1.25),
)
