"""The sources with which the operators give a target: f(s, d) = t solved for s.

f(½, d) = d, so that s ≥ ½ where t ≥ d. Where f is a cubic, it is in w = s − ½ and a = 4(1 − 2d)

    f − d = 2dw + aw²/2 + aw³,    0 ≤ w ≤ ½,

whose coefficients are not negative for d ≤ ½. So it is convex and increasing, Newton's steps from
above its root never pass it, and no sum cancels. The start is the root without aw³, which is above.
Cardano's closed root is not used: it is 0/0 where a = 3 and where d = t = 0.
"""

from collections.abc import Callable

import jax
import jax.numpy as jnp
from jax import Array

from shading.detail.operators import overlay, smooth_overlay, symmetric_overlay
from shading.detail.values import Values

# What keeps denominators from being zero. 1e-30 is exact in float32 and float64.
LEAST = 1e-30
# Slopes of f below this count as this in gradients. Where f is flat in s, at d = 0 or 1, the
# gradient of the source is infinite.
LEAST_SLOPE = 1e-9
# Steps after which the residual is rounding: of float64, and of float32 and less
STEPS, STEPS_FLOAT = 5, 4


def overlay_root(target: Values, detail: Values) -> Array:
    """Return the source of `overlay`, as code is printed of it."""
    t, d = jnp.asarray(target), jnp.asarray(detail)
    return jnp.where(t < d, _below(t, d), 1 - _below(1 - t, 1 - d))


def smooth_overlay_root(
    target: Values, detail: Values, steps: int = STEPS, least: float = LEAST
) -> Array:
    """Return the source of `smooth_overlay` by `steps` steps, as code is printed of it.

    `least` is a number above zero that has an inverse in the type of the arguments.
    """
    t, d = jnp.asarray(target), jnp.asarray(detail)
    bent = (t >= d) & (d < 0.5)
    return jnp.where(bent, 0.5 + _offset(t - d, d, steps, least), overlay_root(t, d))


def symmetric_overlay_root(
    target: Values, detail: Values, steps: int = STEPS, least: float = LEAST
) -> Array:
    """Return the source of `symmetric_overlay` by `steps` steps, as code is printed of it."""
    t, d = jnp.asarray(target), jnp.asarray(detail)
    dark = d < 0.5
    rise = jnp.where(dark, t - d, d - t)
    offset = _offset(rise, jnp.where(dark, d, 1 - d), steps, least)
    return jnp.where(rise >= 0, jnp.where(dark, 0.5 + offset, 0.5 - offset), overlay_root(t, d))


def _below(t: Array, d: Array) -> Array:
    """Return t/(2d), for t ≤ d; ½ for d = 0."""
    return jnp.where(d > 0, 0.5 * t / jnp.where(d > 0, d, 1.0), 0.5)


def _offset(rise: Array, d: Array, steps: int, least: float) -> Array:
    """Return w in [0, ½] with 2dw + aw²/2 + aw³ = `rise`, for d ≤ ½ and 0 ≤ `rise` ≤ 1 − d."""
    rise, d = jnp.maximum(rise, 0.0), jnp.minimum(d, 0.5)
    a = 4 * (1 - 2 * d)
    start = rise / (d + jnp.sqrt(jnp.maximum(d * d + a / 2 * rise, least)))
    w = jnp.minimum(start, 0.5)
    for _ in range(steps):
        excess = w * (2 * d + a * w * (0.5 + w)) - rise
        slope = 2 * d + a * w * (1 + 3 * w)
        w = jnp.clip(w - excess / jnp.maximum(slope, least), 0.0, 0.5)
    return w


def _with_gradients(root: Callable[..., Array], blend: Callable[..., Array], text: str):
    """Return a root with the gradients of the implicit function: 1/f_s, and −f_d/f_s."""

    @jax.custom_jvp
    def source(target: Values, detail: Values) -> Array:
        return root(target, detail)

    @source.defjvp
    def _(primals, tangents):
        (t, d), (dt, dd) = primals, tangents
        s = source(t, d)
        ones, zeros = jnp.ones_like(s), jnp.zeros_like(s)
        d = jnp.broadcast_to(jnp.asarray(d, s.dtype), s.shape)
        _, by_source = jax.jvp(blend, (s, d), (ones, zeros))
        _, by_detail = jax.jvp(blend, (s, d), (zeros, ones))
        return s, (dt - by_detail * dd) / jnp.maximum(by_source, LEAST_SLOPE)

    source.__doc__ = text
    return source


overlay_source = _with_gradients(
    overlay_root, overlay, "Return s with overlay(s, d) = t, for t and d in [0, 1]."
)
smooth_overlay_source = _with_gradients(
    smooth_overlay_root,
    smooth_overlay,
    "Return s with smooth_overlay(s, d) = t, for t and d in [0, 1].",
)
symmetric_overlay_source = _with_gradients(
    symmetric_overlay_root,
    symmetric_overlay,
    "Return s with symmetric_overlay(s, d) = t, for t and d in [0, 1].",
)
