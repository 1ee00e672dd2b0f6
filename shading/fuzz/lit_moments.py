"""Closed moments of the normals of a fibre that reflect a view upwards, where light comes from.

A view v sees the flakes of a fibre with the density D(m) max(v·m, 0)/σ(v). Those that reflect v
above the horizon are lit. In the space where the ellipsoid of the fibre is a unit sphere, the lit
ones are an elliptic cone, and they are uniform over its projection along v. So their second moments
are algebraic in the root λ of the closed form of P_s. docs/ambient-light.md proves the formulas.
"""

from typing import NamedTuple

import jax.numpy as jnp
from jax import Array

from shading.cubic_root import at_least
from shading.fuzz.lit_cone import FLOAT64_STEPS, lit_cone, reflected_up
from shading.types import Scalar


class LitMoments(NamedTuple):
    """Moments of the lit normals. Vectors (3,) are coordinates along n, v and t.

    A flake has the normal w = Mp, where p is a unit vector and M the root of the fibre's matrix.
    Means are over the lit p, which are uniform over their projection along v.

    Attributes:
        root: λ in [α², 1].
        fraction: 1 − P_s(v), the lit part of the visible flakes.
        mean_square: T_w = E|w|², in [α², 1].
        seen: K = E[w wᵀ] v.
        axis: W, along the normal on the axis of the cone, with v·W = (λ + c)(λσ² + α²c).
        direction: r = 2K/T_w − v, the mean of the reflected direction with the weight |w|². It is
            not a unit vector.
        cosine: μ̄ = r·n = λ/(2T_w), the mean cosine of the light with that weight, in (0, 1].
    """

    root: Array
    fraction: Array
    mean_square: Array
    seen: Array
    axis: Array
    direction: Array
    cosine: Array


def lit_moments(
    cos_vn: Scalar,
    cos_vt: Scalar,
    cos_nt: Scalar,
    alpha: Scalar,
    steps: int = FLOAT64_STEPS,
    *,
    sin2_vt: Scalar | None = None,
    sin2_nt: Scalar | None = None,
    least_alpha: float = 1e-6,
) -> LitMoments:
    """Return the moments of the lit normals from v·n ≥ 0, v·t, n·t and α in (0, 1].

    The arguments are those of `scattered_fraction`, with the view v in the place of the light u.
    With c = v·n, a = v·t, b = n·t and the terms λ, κ, σ, m, T, A of `scattered_fraction`,

        Δ = 2λ² + Aλ + m/λ,    B = 2λ + A,    τ = 3λ + A,    f = λ/(4Δ),
        W = (λσ² + m) n + λ(λ + m + T) v − κλ(λa + b) t,
        y = σ² n + (B − T) v + (X − Bκa) t,    X = κ(a(T + m) − σ²b),
        E[w wᵀ] = (1 − 4fτ) WWᵀ/(Δ v·W) + f (BS + S𝐁S) + f (Wyᵀ + yWᵀ)/(v·W),

    where S is the matrix of the fibre and 𝐁 = v nᵀ + n vᵀ − cI.

    v·n may be zero: λ ≥ α² holds there too, so no divisor is zero. The bound on λ in the code keeps
    this true after rounding.
    """
    # notation: as above, with delta = Δ, coeff_b = B, tau = τ, level = λσ² + m, rise = λ + c,
    # lean = λa + b.
    cone = lit_cone(
        cos_vn,
        cos_vt,
        cos_nt,
        alpha,
        steps,
        sin2_ut=sin2_vt,
        sin2_nt=sin2_nt,
        least_alpha=least_alpha,
    )
    root, c, alpha2, kappa, sigma2, t, m, coeff_a = cone
    a, b = jnp.asarray(cos_vt), jnp.asarray(cos_nt)
    coeff_b = root + coeff_a + root
    tau = coeff_b + root
    # Δ/λ has the numerator of `reflected_up`, whose terms do not cancel.
    inverse = root / (coeff_b * root * root + m)
    f = root * inverse / 4
    level, rise, lean = root * sigma2 + m, root + c, root * a + b
    axis = jnp.stack([level, root * (root + m + t), -kappa * root * lean])
    x = kappa * (a * (t + m) - sigma2 * b)
    y = jnp.stack([sigma2, coeff_b - t, x - coeff_b * kappa * a])
    spread = (1 - 4 * f * tau) * inverse
    # y·v / (v·W). The second moment in p along t is (1 − T_w)/κ.
    y_seen = (coeff_b + c) * sigma2 - t + a * x
    seen = 2 * f * y + (spread + f * y_seen / (rise * level)) * axis
    tilted = spread * rise * lean + 2 * f * (a * (coeff_b - t + kappa * c) + sigma2 * b)
    along = f * (coeff_b + 2 * alpha2 * a * b - m) + alpha2 * (lean / level) * tilted
    # T_w ≥ α² is true of unit vectors. For other arguments it keeps the divisor positive.
    mean_square = at_least(1 - kappa * along, alpha2)
    twice = 2 * seen / mean_square
    return LitMoments(
        root,
        reflected_up(cone),
        mean_square,
        seen,
        axis,
        jnp.stack([twice[0], twice[1] - 1, twice[2]]),
        root / (2 * mean_square),
    )
