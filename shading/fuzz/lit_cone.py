"""The cone of normals of a fibre that reflect a direction upwards, and the part of it that is seen.

Map the ellipsoid of the fibre to the unit sphere. The normals that reflect u above the horizon are
then an elliptic cone, whose eigenvalue λ is the positive root of a cubic. docs/closed-form.md
proves the formulas. The closed form of P_s and the moments of the lit normals use them.
"""

from typing import NamedTuple

import jax.numpy as jnp
from jax import Array

from shading.cubic_root import at_least, magnitude, newton_step, positive_root
from shading.types import Scalar

# Numbers of Newton steps that reach the precision of the type (tests/integrals/test_ps.py).
FLOAT64_STEPS = 4
FLOAT32_STEPS = 2
# With one step, P_s has an error of at most 3e-4 (docs/closed-form.md).
FEWEST_STEPS = 1
# The start contains a guess of λ, p/2 + √(p²/4 + WIDTH α²). This value of WIDTH minimises the error
# after two steps.
WIDTH = 0.42


class LitCone(NamedTuple):
    """The cone of normals that reflect u upwards: λ and the terms of its equation, scalars.

    The names are those of `scattered_fraction`: `cosine` is c, `alpha2` is α², `kappa` is κ,
    `sigma2` is σ_u², `product` is T, `lift` is m, and `coefficient` is A.
    """

    root: Array
    cosine: Array
    alpha2: Array
    kappa: Array
    sigma2: Array
    product: Array
    lift: Array
    coefficient: Array


def scattered_fraction(
    cos_un: Scalar,
    cos_ut: Scalar,
    cos_nt: Scalar,
    alpha: Scalar,
    steps: int = FLOAT64_STEPS,
    *,
    sin2_ut: Scalar | None = None,
    sin2_nt: Scalar | None = None,
    least_alpha: float = 1e-6,
) -> Array:
    """Return P_s in closed form from u·n ≥ 0, u·t, n·t and α in (0, 1].

    The normals that reflect u upwards fill an elliptic cone. Map the ellipsoid of the fibre to the
    unit sphere and project it along the light. The image of the cone then covers the part 1 − P_s
    of the disk of visible normals:

        1 − P_s = λ² √((λ + c)(λ + m/σ_u²)) / (2λ³ + Aλ² + m),

    with c = u·n, a = u·t, b = n·t, κ = 1 − α², σ_u² = 1 − κa², σ_n² = 1 − κb², m = α²c, T = κab,
    S = σ_u σ_n, A = m + 2T and E = S² − T². λ in (0, 1] is the positive root of

        λ (λ − S + T)(λ + S + T) = m (1 − λ²),  that is  λ³ + Aλ² − Eλ − m = 0.

    docs/closed-form.md proves this, and shows why this start needs so few Newton `steps`. The lower
    bounds in the code are true of exact values. They only prevent 0/0 that rounding may cause, or
    cosines that belong to no unit vectors.

    `sin2_ut` and `sin2_nt` are 1 − (u·t)² and 1 − (n·t)². A caller that has the angles can compute
    them more precisely than from the rounded cosines. This matters because P_s depends on their
    ratio to α². An α below `least_alpha` is raised to it. The default keeps α⁴ in the range of
    float32.
    """
    cone = lit_cone(
        cos_un,
        cos_ut,
        cos_nt,
        alpha,
        steps,
        sin2_ut=sin2_ut,
        sin2_nt=sin2_nt,
        least_alpha=least_alpha,
    )
    return 1 - reflected_up(cone)


def reflected_up(cone: LitCone) -> Array:
    """Return 1 − P_s, the part of the visible normals that lies in the `cone`."""
    root, coeff_a, m = cone.root, cone.coefficient, cone.lift
    root2 = root * root
    ellipse = root2 * jnp.sqrt((root + cone.cosine) * (root + m / cone.sigma2))
    return ellipse / ((root + coeff_a + root) * root2 + m)


def lit_cone(
    cos_un: Scalar,
    cos_ut: Scalar,
    cos_nt: Scalar,
    alpha: Scalar,
    steps: int = FLOAT64_STEPS,
    *,
    sin2_ut: Scalar | None = None,
    sin2_nt: Scalar | None = None,
    least_alpha: float = 1e-6,
) -> LitCone:
    """Return λ and the terms of its equation. The arguments are those of `scattered_fraction`."""
    # notation: c, a, b, α, κ, T, S, m as above, p = S − T, r = S + T, coeff_a = A, coeff_e = E.
    c, a, b, alpha = map(jnp.asarray, (cos_un, cos_ut, cos_nt, alpha))
    c, alpha = magnitude(c), at_least(alpha, least_alpha)
    alpha2 = alpha * alpha
    kappa = 1 - alpha2
    # The product for 1 − a² has a small relative error. This matters because α² is added to it.
    sin2_ut = magnitude((1 - a) * (1 + a) if sin2_ut is None else jnp.asarray(sin2_ut))
    sin2_nt = magnitude((1 - b) * (1 + b) if sin2_nt is None else jnp.asarray(sin2_nt))
    sigma2 = alpha2 + kappa * sin2_ut
    t = kappa * (a * b)
    s = jnp.sqrt(sigma2 * (alpha2 + kappa * sin2_nt))
    # The rest uses only p, r and m. Each is exact up to a few roundings, so the cubic is the exact
    # one of a nearby point. r ≥ 0 for unit vectors. For other arguments its magnitude keeps the
    # root simple.
    p = s - t
    r = magnitude(s + t)
    m = alpha2 * c
    coeff_a = m + (r - p)
    coeff_e = p * r
    # Start: put a guess of λ into the factor λ + S + T, and solve the quadratic that remains.
    half_p = p / 2
    frozen = r + (half_p + jnp.sqrt(half_p * half_p + WIDTH * alpha2))
    h = half_p * frozen
    divisor = frozen + m
    start = at_least((h + jnp.sqrt(h * h + m * divisor)) / divisor, alpha2)
    root = at_least(positive_root(coeff_a, coeff_e, m, start, newton_step, steps), alpha2)
    return LitCone(root, c, alpha2, kappa, sigma2, t, m, coeff_a)
