"""P_s, the fraction of light that a fibre layer scatters towards the base.

P_s(u; α, θf) = 1 − ∫_Ω p_F(u, v) dω_v over the upper hemisphere Ω, with p_F the fibre-like SGGX
phase function. The supplement fits it (Eq. 1 and 2) for want of a closed form; docs/closed-form.md
derives the one used here.
"""

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from integrals.fuzz.cubic_root import at_least, magnitude, newton_step, positive_root, tangent_step
from integrals.monte_carlo import Sequence, indicator, mean_estimate, unit_points
from integrals.reference import Axis, Estimate, Reference, leg
from integrals.rules.interval import checked_rule, gauss_legendre
from integrals.sampling import Measure, Sampling
from shading import (
    direction,
    fiber_direction,
    fiber_normal_distribution,
    fiber_root,
    normal_distribution,
    projected_area,
    reflect,
    sin2_between,
    visible_normal,
)
from shading.types import Matrix, Scalar, Vector

ALPHA = Axis("alpha", "α", "1", 0.0, 1.0, "projected area along the fibre", open_below=True)
THETA_F = Axis("theta_f", "θf", "rad", 0.0, np.pi / 2, "polar angle of the fibre")
THETA_U = Axis("theta_u", "θu", "rad", 0.0, np.pi / 2, "polar angle of the light")
PHI = Axis(
    "phi",
    "φ",
    "rad",
    -2 * np.pi,
    2 * np.pi,
    "azimuth of the light relative to the fibre",
    period=2 * np.pi,
)
AXES = (ALPHA, THETA_F, THETA_U, PHI)


# Newton's steps that reach float64 (4) and float32 (2): tests/test_ps.py.
FLOAT64_STEPS = 4
FLOAT32_STEPS = 2
# Steps for a general matrix, whose start may be far above the root.
GENERAL_STEPS = 10
# The start guesses λ by p/2 + √(p²/4 + WIDTH α²): this makes the error after two steps least.
WIDTH = 0.42

# Below, P_s at angles that float64 can hold is at its limit, and α⁶ leaves the range.
LEAST_ALPHA = 1e-50


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
    """Give P_s in closed form from u·n ≥ 0, u·t, n·t and α in (0, 1].

    The normals that reflect u upwards fill an elliptic cone. Mapped to the unit sphere of the
    SGGX ellipsoid and projected along the light, it covers the part 1 − P_s of the visible disk:

        1 − P_s = λ² √((λ + c)(λ + m/σ_u²)) / (2λ³ + Aλ² + m),

    with c = u·n, a = u·t, b = n·t, κ = 1 − α², σ_u² = 1 − κa², σ_n² = 1 − κb², m = α²c, T = κab,
    S = σ_u σ_n, A = m + 2T, E = S² − T², and λ in (0, 1] the positive root of

        λ (λ − S + T)(λ + S + T) = m (1 − λ²),  that is  λ³ + Aλ² − Eλ − m = 0.

    docs/closed-form.md has the proof, and why so few of Newton's steps suffice from this start.
    The floors are theorems: they only keep rounding, and cosines of no unit vectors, from 0/0.

    `sin2_ut` and `sin2_nt` are 1 − (u·t)² and 1 − (n·t)², for callers that know them better than
    the rounded cosines do: P_s depends on their ratio to α². α is raised to `least_alpha`, below
    which α⁴ leaves the range of float32.
    """
    # notation: c, a, b, α, κ, T, S, m as above; p = S − T, r = S + T; A and E have those names.
    c, a, b, alpha = map(jnp.asarray, (cos_un, cos_ut, cos_nt, alpha))
    c, alpha = magnitude(c), at_least(alpha, least_alpha)
    alpha2 = alpha * alpha
    kappa = 1 - alpha2
    # 1 − a² as a product: its relative accuracy is what α² is weighed against.
    sin2_ut = magnitude((1 - a) * (1 + a) if sin2_ut is None else jnp.asarray(sin2_ut))
    sin2_nt = magnitude((1 - b) * (1 + b) if sin2_nt is None else jnp.asarray(sin2_nt))
    sigma2 = alpha2 + kappa * sin2_ut
    t = kappa * (a * b)
    s = jnp.sqrt(sigma2 * (alpha2 + kappa * sin2_nt))
    # All else is made of p, r and m, none of which cancels to more than its own rounding: the
    # cubic that is solved is exact for slightly other ones. Of unit vectors r is never negative;
    # for other arguments its magnitude keeps the root simple.
    p = s - t
    r = magnitude(s + t)
    m = alpha2 * c
    coeff_a = m + (r - p)
    coeff_e = p * r
    # Start: the factor λ + S + T takes a guess of λ, and the quadratic that is left is solved.
    half_p = p / 2
    frozen = r + (half_p + jnp.sqrt(half_p * half_p + WIDTH * alpha2))
    h = half_p * frozen
    divisor = frozen + m
    start = at_least((h + jnp.sqrt(h * h + m * divisor)) / divisor, alpha2)
    root = at_least(positive_root(coeff_a, coeff_e, m, start, newton_step, steps), alpha2)
    root2 = root * root
    ellipse = root2 * jnp.sqrt((root + c) * (root + m / sigma2))
    return 1 - ellipse / ((root + coeff_a + root) * root2 + m)


def sggx_scattered_fraction(matrix: Matrix, light: Vector) -> Array:
    """Give P_s in closed form for any SGGX matrix S (3, 3) and unit vector u with u·n ≥ 0.

    S is symmetric positive definite; P_s depends on it up to a positive factor. The rounding
    error is about the unit roundoff times the condition number of S.
    """
    # notation: B = u nᵀ + n uᵀ − (u·n) I; C = S^½ B S^½ shares the invariants e₁, e₂, e₃ of S B,
    # and ẑ = S^½u/σ is the light in the ellipsoid's unit-sphere space.
    matrix, light = jnp.asarray(matrix), jnp.asarray(light)
    normal = jnp.array([0.0, 0.0, 1.0])
    cos_un = light @ normal
    cone = jnp.outer(light, normal) + jnp.outer(normal, light) - cos_un * jnp.eye(3)
    product = matrix @ cone
    e1 = jnp.trace(product)
    e2 = (e1 * e1 - jnp.trace(product @ product)) / 2
    e3 = jnp.linalg.det(matrix) * cos_un
    sigma2 = light @ matrix @ light
    upper_bound = normal @ matrix @ light + jnp.sqrt(sigma2 * (normal @ matrix @ normal))
    root = positive_root(-e1, -e2, e3, upper_bound, tangent_step, GENERAL_STEPS)
    seen = matrix @ light
    image = cone @ seen
    first, second = seen @ image / sigma2, image @ matrix @ image / sigma2  # ẑᵀCẑ, ẑᵀC²ẑ
    alignment = second - (e1 - root) * first + e3 / root
    return 1 - root * jnp.sqrt(alignment) / (2 * root * root - e1 * root + e3 / root)


@leg(*AXES)
def closed_form(alpha, theta_f, theta_u, phi) -> Estimate:
    """Evaluate the closed form; its rounding error grows as α falls."""
    value = fraction_at(alpha, theta_f, theta_u, phi)
    return Estimate(value, 4 * np.finfo(float).eps / alpha)


def fraction_at(alpha: Scalar, theta_f: Scalar, theta_u: Scalar, phi: Scalar) -> Array:
    """Give the closed form of P_s from α and the angles θf, θu, φ in radians, in float64."""
    light, fiber = direction(theta_u, phi), fiber_direction(theta_f)
    return scattered_fraction(
        light[2],
        light @ fiber,
        fiber[2],
        alpha,
        sin2_ut=sin2_between(theta_u, theta_f, phi),
        sin2_nt=jnp.sin(theta_f) ** 2,
        least_alpha=LEAST_ALPHA,
    )


def hemisphere_integral(distribution, sigma_u, theta_u, phi, nodes: int) -> Array:
    """Integrate p(u, v) = D(h) / (4σ(u)) over the upper hemisphere of v.

    `distribution` maps unit vectors h, shape (3,), to D(h). In v the integrand has no limit at
    v = −u; in h, with dω_v = 4 (u·h) dω_h, it is smooth. With m, e the unit vectors along u + n
    and u − n and k across them, the upward v are h = cos η (cos ξ m + sin ξ e) + sin η k with
    (u·n) tan²η < cos 2ξ. The outer variable ω, (1 + u·n)^½ sin η = sin ω, runs over ±π/2 and the
    inner one is ξ/ξ_max(η): as u grazes, all that happens at a vanishing scale is where cos η and
    u·h vanish too.
    """
    omegas, outer_weights = gauss_legendre(nodes, -np.pi / 2, np.pi / 2)
    x, inner_weights = gauss_legendre(nodes, -1.0, 1.0)
    cos_un, half, azimuth = jnp.cos(theta_u), theta_u / 2, jnp.stack([jnp.cos(phi), jnp.sin(phi)])
    m = jnp.concatenate([jnp.sin(half) * azimuth, jnp.cos(half)[None]])
    e = jnp.concatenate([jnp.cos(half) * azimuth, -jnp.sin(half)[None]])
    k = jnp.stack([-azimuth[1], azimuth[0], jnp.zeros(())])

    def row(omega, weight):
        stretch, width = 1 + cos_un, cos_un + jnp.cos(omega) ** 2
        sin_eta, cos_eta = jnp.sin(omega) / jnp.sqrt(stretch), jnp.sqrt(width / stretch)
        xi_max = jnp.arcsin(jnp.cos(omega) * jnp.sqrt(stretch / (2 * width)))
        cos_xi, sin_xi = jnp.cos(xi_max * x), jnp.sin(xi_max * x)
        h = cos_eta * (cos_xi[:, None] * m + sin_xi[:, None] * e) + sin_eta * k
        cos_uh = cos_eta * (cos_xi * jnp.cos(half) + sin_xi * jnp.sin(half))
        mean = jnp.sum(inner_weights * jax.vmap(distribution)(h) * cos_uh)
        return weight * jnp.cos(omega) / jnp.sqrt(stretch) * xi_max * mean

    return jnp.sum(jax.vmap(row)(omegas, outer_weights)) / sigma_u


def _quadrature(distribution, sigma_u, theta_u, phi, alpha, nodes: int) -> Estimate:
    """Apply the rule; `alpha` is the ratio of the ellipsoid's least to its largest axis."""

    def rule(count: int) -> Array:
        return 1 - hemisphere_integral(distribution, sigma_u, theta_u, phi, count)

    estimate = checked_rule(rule, nodes, 1e-14)
    # D is a ridge of width α. Rules that step over it agree on a wrong value, so that their
    # difference is no evidence: what the ridge can hide, as the rule's convergence bounds it.
    resolution = nodes * alpha
    hidden = jnp.minimum(1.0, 2 * (1 + resolution) * jnp.exp(-1.2 * resolution))
    # The rounding of u, h and S counts against σ² and α.
    rounding = np.finfo(float).eps * (4 / sigma_u**2 + 8 / alpha)
    error = estimate.error + hidden * (1 + jnp.abs(estimate.value)) + rounding
    return Estimate(estimate.value, error)


@leg(*AXES)
def quadrature(alpha, theta_f, theta_u, phi, *, nodes: int = 256) -> Estimate:
    """Integrate the definition by a product rule of nodes².

    The error is judged against (¾ nodes)² and by whether the nodes resolve α.
    """
    fiber = fiber_direction(theta_f)
    sin2_ut = sin2_between(theta_u, theta_f, phi)
    sigma_u = jnp.sqrt(sin2_ut + alpha**2 * (1 - sin2_ut))
    return _quadrature(
        lambda h: fiber_normal_distribution(h @ fiber, alpha), sigma_u, theta_u, phi, alpha, nodes
    )


def sggx_quadrature(matrix: Matrix, theta_u: Scalar, phi: Scalar, *, nodes: int = 256) -> Estimate:
    """Integrate the definition for any SGGX matrix S (3, 3); angles in radians."""
    theta_u, phi = jnp.asarray(theta_u), jnp.asarray(phi)
    least, _, largest = jnp.linalg.eigvalsh(jax.lax.stop_gradient(jnp.asarray(matrix)))
    matrix, alpha = matrix / largest, jnp.sqrt(least / largest)
    sigma_u = projected_area(matrix, direction(theta_u, phi))
    return _quadrature(
        lambda h: normal_distribution(matrix, h), sigma_u, theta_u, phi, alpha, nodes
    )


@leg(*AXES)
def monte_carlo(
    alpha,
    theta_f,
    theta_u,
    phi,
    *,
    samples: int = 1 << 16,
    sequence: Sequence = "random",
    seed: int = 0,
) -> Estimate:
    """Draw visible normals, reflect the light, and count what goes down. Not differentiable."""
    root, light = fiber_root(fiber_direction(theta_f), alpha), direction(theta_u, phi)
    points = unit_points(samples, 2, sequence, seed)

    def goes_down(point):
        return indicator(-reflect(light, visible_normal(root, light, point))[2])

    return mean_estimate(jax.vmap(jax.vmap(goes_down))(points))


# P_s varies within this many α of the fibre's direction.
_RING = 5.0


def _near_fibre(points: np.ndarray) -> np.ndarray:
    """Move the lights of points (α, θf, θu, φ) to within RING α of the fibre, above the surface."""
    alpha, theta_f, theta_u, phi = points.T
    distance = _RING * alpha * (theta_u / (np.pi / 2)) ** 1.5
    fibre = np.stack([np.sin(theta_f), 0 * theta_f, np.cos(theta_f)])
    across = np.stack([np.cos(theta_f), 0 * theta_f, -np.sin(theta_f)])
    side = np.array([0.0, 1.0, 0.0])[:, None]
    around = np.cos(phi) * across + np.sin(phi) * side
    x, y, z = np.cos(distance) * fibre + np.sin(distance) * around
    theta = np.arctan2(np.hypot(x, y), np.maximum(z, 0))
    return np.stack([alpha, theta_f, np.minimum(theta, np.pi / 2), np.arctan2(y, x)], axis=1)


def _sine(points: np.ndarray) -> np.ndarray:
    return np.sin(points[:, 2])


def _cosine(points: np.ndarray) -> np.ndarray:
    return np.cos(points[:, 2])


# A light's direction counts by angle, by solid angle, or by projected solid angle. The largest
# error with 'cosine' is that of the light that arrives: it is multiplied by cos θu.
MEASURES = {
    "uniform": Measure(),
    "solid-angle": Measure(density=_sine),
    "cosine": Measure(density=lambda points: _sine(points) * _cosine(points), largest=_cosine),
}

PS = Reference(
    name="ps",
    symbol="P_s",
    meaning="fraction of light that the fibre layer scatters towards the base",
    definition="1 − ∫_Ω p_F(u, v) dω_v",
    axes=AXES,
    sampling=Sampling(fitted=13, checked=15, judged=17, extra=_near_fibre, measures=MEASURES),
    closed_form=closed_form,
    quadrature=quadrature,
    monte_carlo=monte_carlo,
)
