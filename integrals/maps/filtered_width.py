"""The GGX lobe nearest to a GGX lobe whose normals are spread by a Gaussian.

The slopes of GGX of width α are α √(1/E) times a pair of Gaussian numbers of variance ½, where E
has the density e^(−E). A Gaussian spread of variance v along each axis is added. The variance then
is α²/(2E) + v, or (α² + v) V with V = (1 − u)/(2E) + u, where u = v/(α² + v) is the share of the
spread. The density of slopes of GGX of squared width (α² + v) w is that of 1/(π w (1 + q)²) with
q = s²/((α² + v) w). The mean of its logarithm, over the spread slopes, is largest where

    E[q/(1 + q)] = ½, or along two axes E[q₁/(1 + q₁ + q₂)] = ¼ and the same for q₂.

This w has the least Kullback–Leibler divergence. docs/sggx-maps.md derives the equations.
"""

import functools
from collections.abc import Callable

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from integrals.monte_carlo import Sequence, mean_estimate, unit_points
from integrals.reference import Estimate
from integrals.rules.interval import checked_steps, exponential_decay
from integrals.special.exponential import e1
from shading.types import Scalar

STEP, WIDE_STEP = 1 / 16, 1 / 10
_NEWTON_STEPS = 6
# Rounding of sums of about 100 terms, and what the ends of the rule leave out.
_ROUNDING = 1e-13
# w(1), the widening of a mirror: x eˣ E₁(x) = ½ has the root x = w/2 = 0.6100578….
MIRROR = 1.2201155836697488


def _logarithmic_newton(residual: Callable[[Array], Array], start: Array, steps: int) -> Array:
    """Return the root g > 0 of `residual` by Newton's method in ln g.

    The steps are not differentiated. One more step from the root, with a constant slope, gives the
    value and, as the implicit function theorem has it, the right derivative.
    """

    def in_log(u: Array) -> Array:
        return residual(jnp.exp(u))

    def step(_, u: Array) -> Array:
        return u - _solve(jax.jacfwd(in_log)(u), in_log(u))

    u = jax.lax.stop_gradient(jax.lax.fori_loop(0, steps, step, jnp.log(start)))
    slope = jax.lax.stop_gradient(jax.jacfwd(in_log)(u))
    return jnp.exp(u - _solve(slope, in_log(u)))


def _solve(slope: Array, value: Array) -> Array:
    """Divide by a number, or by a matrix (2, 2)."""
    if slope.ndim == 0:
        return value / slope
    (a, b), (c, d) = slope
    return jnp.stack([d * value[0] - b * value[1], a * value[1] - c * value[0]]) / (a * d - b * c)


def widening_rule(share: Array, step: float) -> Array:
    """Return w(u) by the trapezoid rule over E; the inner average is ψ(x) = x eˣ E₁(x)."""
    nodes, weights = exponential_decay(step)
    weights = weights * np.exp(-nodes)
    spread = (1 - share) / nodes + 2 * share

    def residual(w: Array) -> Array:
        x = w / spread
        return jnp.sum(weights * x * jnp.exp(x) * jax.vmap(e1)(x)) - 0.5

    return _logarithmic_newton(residual, jnp.ones(()), _NEWTON_STEPS)


def widening(share: Scalar, *, step: float = STEP) -> Estimate:
    """Return w(u) and a bound on its error for u in [0, 1], by a one-dimensional integral."""
    share = jnp.asarray(share, dtype=float)
    return checked_steps(functools.partial(widening_rule, share), step, _ROUNDING)


def axis_widenings_rule(along: Array, across: Array, step: float) -> Array:
    """Return (w₁, w₂) for the shares u₁ and u₂ along the axes, by a product rule over E and r.

    1/(1 + q₁ + q₂) is the integral of e^(−r (1 + q₁ + q₂)) over r, and the Gaussian average of
    q₁ e^(−r (q₁ + q₂)) is λ₁ (1 + 2rλ₁)^(−3/2) (1 + 2rλ₂)^(−1/2) with λᵢ = Vᵢ/wᵢ.
    """
    nodes, weights = exponential_decay(step)
    weights = weights * np.exp(-nodes)
    spread = jnp.stack([(1 - each) / (2 * nodes) + each for each in (along, across)])

    def averages(w: Array) -> Array:
        scaled = spread / w[:, None]
        stretch = 1 + 2 * nodes[:, None] * scaled[:, None, :]
        both = jnp.sqrt(stretch[0] * stretch[1])
        inner = jnp.einsum("j,ajk->ak", weights, 1 / (both * stretch))
        return jnp.sum(weights * scaled * inner, axis=1)

    start = 1 + 0.25 * jnp.stack([across, along])
    return _logarithmic_newton(lambda w: averages(w) - 0.25, start, _NEWTON_STEPS)


def axis_widening(along: Scalar, across: Scalar, *, step: float = WIDE_STEP) -> Estimate:
    """Return w₁(u₁, u₂) and a bound on its error: the widening along the axis of u₁.

    w₂ is w₁(u₂, u₁).
    """
    along, across = jnp.asarray(along, dtype=float), jnp.asarray(across, dtype=float)
    return checked_steps(lambda each: axis_widenings_rule(along, across, each)[0], step, _ROUNDING)


def axis_widening_by_sampling(
    along: Scalar,
    across: Scalar,
    *,
    samples: int = 1 << 16,
    sequence: Sequence = "random",
    seed: int = 0,
) -> Estimate:
    """Return w₁ and its standard error by Monte Carlo: the lobe that fits a sample of slopes best.

    The slopes are those of GGX plus Gaussian ones. The standard error is that of the mean of the
    equations, times the inverse of their derivative.
    """
    points = jnp.asarray(unit_points(samples, 4, sequence, seed))
    u, angle, other, turn = (points[..., k] for k in range(4))
    rough = jnp.sqrt(u / (1 - u))
    gauss = jnp.sqrt(-2 * jnp.log1p(-other))
    shares = jnp.stack([jnp.asarray(along, dtype=float), jnp.asarray(across, dtype=float)])
    slopes = [
        jnp.sqrt(1 - each) * rough * wave(2 * jnp.pi * angle)
        + jnp.sqrt(each) * gauss * wave(2 * jnp.pi * turn)
        for wave, each in zip((jnp.cos, jnp.sin), shares, strict=True)
    ]
    squares = jnp.stack(slopes) ** 2

    def parts(w: Array) -> Array:
        q = squares / w[:, None, None]
        return q / (1 + q[0] + q[1])

    def averages(w: Array) -> Array:
        return jnp.mean(parts(w), axis=(1, 2))

    w = _logarithmic_newton(lambda w: averages(w) - 0.25, jnp.ones(2), _NEWTON_STEPS)
    slope = jax.jacfwd(lambda log: averages(jnp.exp(log)))(jnp.log(w))
    return mean_estimate(w[0] * (1 - _solve(slope, parts(w) - 0.25)[0]))
