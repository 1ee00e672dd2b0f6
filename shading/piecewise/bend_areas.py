"""What a change of the slope of D at a knot adds to the hidden area H, to full relative precision.

D that is linear in cos²θ between knots is a sum of max(u² − v², 0) over the cosines v of the inner
knots, times the changes of its slope there. So H is a sum of T(v) = ∫ (u² − v²) K(u) du over u from
v to sin θo, where K ≥ 0 is the kernel of H (`hidden_area`). For D that is convex in cos²θ, as that
of GGX, all terms are positive. In closed form, with s, c, h, A and δ as in `hidden_area`,

    T(u) = A(h²/4 − hu² − cu⁴/2) + ur(1 + 2u²)/4 − (c/2)(1 − u²)²δ.

T is of the order of tan⁷A, while these terms are of that of tan A. With t = tan A, x = t/c and
z = c², series take its place where that matters:

    T = s⁴t⁵ cos⁴A Σ_{m≥1} (−1)^{m+1} 4 S_m x^{2m} / ((2m+1)(2m+3)(2m+5)),  S_m = Σ_{j≤m} j z^{j−1},
    T = cos⁴A (Σ_{k≥3} t^{2k+1} (q_k/2) (k − 1 − (k − 2)z) − (c⁵/2) Q(x)),
    q_k = 8(−1)^k/((2k−3)(2k−1)(2k+1)),   Q = (1 + x²)² atan x − x − (5/3)x³ − (8/15)x⁵.

The first is for x < ½. In the second, Q(x) = −x(1 + x²)² Σ_{n≥3} E_n yⁿ/(2n) has terms of one sign,
with y = x²/(1 + x²) and E_n = Π_{j≤n} 2j/(2j+1) (Euler's series of the arctangent).
"""

import jax.numpy as jnp
import numpy as np
from jax import Array
from jax.typing import ArrayLike

from shading.types import Scalar

# The series are taken below these x and t; in the second, Q by its series below this y. The numbers
# of terms leave less than 1e-17 of T.
_NEAR, _NARROW, _EULER = 0.5, 0.5, 0.6
_M = np.arange(1, 27)
_OF_X = (-1.0) ** (_M + 1) * 4 / ((2 * _M + 1) * (2 * _M + 3) * (2 * _M + 5))
_K = np.arange(3, 30)
_OF_T = (-1.0) ** _K * 4 / ((2 * _K - 3) * (2 * _K - 1) * (2 * _K + 1))
_N = np.arange(1, 62)
_OF_Y = (np.cumprod(2 * _N / (2 * _N + 1)) / (2 * _N))[2:]
# Nearer to the normal than this cosine, the second series cancels by s⁴, and the closed form holds.
_HIGH = 0.8


def bend_areas(u: ArrayLike, rim: ArrayLike, theta_o: Scalar) -> Array:
    """Return T at cosines u in (0, sin θo], elementwise; 0 where r = 0.

    `rim` is r = √(sin²θo − u²), which the caller knows without cancellation (`beyond_edge`).
    """
    u, rim, theta_o = (jnp.asarray(each) for each in (u, rim, theta_o))
    c, s = jnp.cos(theta_o), jnp.sin(theta_o)
    open_ = rim > 0
    u, rim = jnp.where(open_, u, 1.0), jnp.where(open_, rim, 1.0)
    t = rim / u
    near, narrow = t < _NEAR * c, (t < _NARROW) & (c < _HIGH)
    x = jnp.where(near | (t < 2 * c), t, 0.0) / jnp.where(c > 0, c, 1.0)
    flat = 1 / (1 + t * t)
    first = s**4 * t**5 * _near(jnp.where(near, x, 0.0), c)
    second = _narrow(jnp.where(narrow, t, 0.1), c) + _euler_or_not(t, x, c)
    series = flat * flat * jnp.where(near, first, second)
    direct = _direct(u, rim, theta_o)
    return jnp.where(open_, jnp.where(near | narrow, series, direct), 0.0)


def _near(x: Array, c: Array) -> Array:
    sums = jnp.cumsum(_M * (c * c) ** (_M - 1))
    return x * x * _polynomial(_OF_X * sums, x * x)


def _narrow(t: Array, c: Array) -> Array:
    return t**7 * _polynomial(_OF_T * (_K - 1 - (_K - 2) * c * c), t * t)


def _euler_or_not(t: Array, x: Array, c: Array) -> Array:
    """Return −(c⁵/2) Q(t/c), where x = t/c if that is below 2, else 0."""
    y = x * x / (1 + x * x)
    below = (x > 0) & (y < _EULER)
    small = jnp.where(below, y, 0.0)
    length = c * c + t * t
    euler = c / 2 * length * length * x * small**3 * _polynomial(_OF_Y, small)
    polynomial = t * (c**4 + t * t * (5 / 3 * c * c + 8 / 15 * t * t))
    direct = (polynomial - c * length * length * jnp.arctan2(t, c)) / 2
    return jnp.where(below, euler, direct)


def _direct(u: Array, rim: Array, theta_o: Array) -> Array:
    c, h = jnp.cos(theta_o), 2 * jnp.sin(theta_o / 2) ** 2
    u2, chord = u * u, u * rim
    delta = jnp.arctan2(h * chord, c * u2 + rim * rim)
    level = h * (h / 4 - u2) - c * u2 * u2 / 2
    return jnp.arctan2(rim, u) * level + chord * (1 + 2 * u2) / 4 - c / 2 * (1 - u2) ** 2 * delta


def _polynomial(coefficients: Array | np.ndarray, x: Array) -> Array:
    """Return Σ coefficientsₖ xᵏ. The loop is kept, so that it compiles faster."""
    return jnp.polyval(jnp.asarray(coefficients)[::-1], x, unroll=1)
