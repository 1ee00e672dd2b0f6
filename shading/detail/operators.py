"""Three operators that put a detail onto a source: overlay and its two smooth kinds.

The formulas are those of Patry, "Samurai Shading in Ghost of Tsushima" (2020), bonus slides "Detail
Maps", simplified. All are monotone in the source, and f(½, d) = d, f(0, d) = 0, f(1, d) = 1.

The arguments are in [0, 1]: two numbers, or arrays that are combined element by element.
"""

import jax.numpy as jnp
from jax import Array

from shading.detail.values import Values


def overlay(source: Values, detail: Values) -> Array:
    """Return 2sd for s < ½, else 1 − 2(1 − s)(1 − d). Its slope in s jumps by 2 − 4d at s = ½."""
    s, d = jnp.asarray(source), jnp.asarray(detail)
    return jnp.where(s < 0.5, 2 * s * d, 1 - 2 * (1 - s) * (1 - d))


def smooth_overlay(source: Values, detail: Values) -> Array:
    """Return the talk's f_os, which has no jump of its slope for d < ½.

    It is overlay, but s (1 − 4(1 − 2d) s (1 − s)) where s ≥ ½ and d < ½. There the slope in s is up
    to 5 − 8d, while that of overlay is 2 − 2d.
    """
    s, d = jnp.asarray(source), jnp.asarray(detail)
    return jnp.where((s >= 0.5) & (d < 0.5), _smooth(s, d), overlay(s, d))


def symmetric_overlay(source: Values, detail: Values) -> Array:
    """Return the talk's f_oss, which has no jump of its slope for any d.

    It is f_os, but 1 − f_os(1 − s, 1 − d) where s < ½ and d ≥ ½.
    """
    s, d = jnp.asarray(source), jnp.asarray(detail)
    mirrored = 1 - _smooth(1 - s, 1 - d)
    return jnp.where((s < 0.5) & (d >= 0.5), mirrored, smooth_overlay(s, d))


def _smooth(s: Array, d: Array) -> Array:
    """Return lerp(2sd, s, (2s − 1)²) as the talk prints it, with fewer operations."""
    return s * (1 - 4 * (1 - 2 * d) * s * (1 - s))
