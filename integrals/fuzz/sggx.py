"""P_s for any SGGX matrix: the closed form, and quadrature of the definition.

P_s(u) = 1 − ∫_Ω p(u, v) dω_v, where Ω is the upper hemisphere and p is the SGGX phase function.
docs/closed-form.md derives the closed form. `integrals.fuzz.ps` has the case of a fibre.
"""

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from integrals.reference import Estimate
from integrals.rules.interval import checked_rule, gauss_legendre
from shading import direction, normal_distribution, projected_area
from shading.cubic_root import positive_root, tangent_step
from shading.types import Matrix, Scalar, Vector

# Many steps, because the start may be far above the root.
GENERAL_STEPS = 10


def sggx_scattered_fraction(matrix: Matrix, light: Vector) -> Array:
    """Return P_s in closed form for an SGGX matrix S (3, 3) and a unit vector u with u·n ≥ 0.

    S is symmetric positive definite. A positive factor of S does not change P_s. The rounding error
    is about the unit roundoff times the condition number of S.
    """
    # notation: B = u nᵀ + n uᵀ − (u·n) I, which is `cone`. C = S^½ B S^½ has the same invariants
    # e₁, e₂, e₃ as S B. ẑ = S^½u/σ is the light in the space where the ellipsoid is a unit sphere.
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


def hemisphere_integral(distribution, sigma_u, theta_u, phi, nodes: int) -> Array:
    """Integrate p(u, v) = D(h) / (4σ(u)) over the upper hemisphere of v with `nodes`² points.

    `distribution` maps a unit vector h (3,) to D(h). `sigma_u` is σ(u). `theta_u` and `phi` are
    the angles of u in radians.

    The integration variable is h, with dω_v = 4 (u·h) dω_h. As a function of v the integrand has no
    limit at v = −u, but as a function of h it is smooth. Let m and e be the unit vectors along
    u + n and u − n, and k the unit vector at right angles to both. Then
    h = cos η (cos ξ m + sin ξ e) + sin η k gives an upward v where (u·n) tan²η < cos 2ξ.

    The outer variable ω is in ±π/2 with (1 + u·n)^½ sin η = sin ω. The inner variable is ξ/ξ_max(η)
    in ±1. With these, grazing light causes no trouble: the integrand then changes rapidly only
    where cos η and u·h go to zero, and there it is small.
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


def fraction_by_quadrature(distribution, sigma_u, theta_u, phi, alpha, nodes: int) -> Estimate:
    """Return P_s by `hemisphere_integral`, with a bound on its error.

    `alpha` is the ratio of the smallest to the largest axis of the ellipsoid. The other arguments
    are those of `hemisphere_integral`.
    """

    def rule(count: int) -> Array:
        return 1 - hemisphere_integral(distribution, sigma_u, theta_u, phi, count)

    estimate = checked_rule(rule, nodes, 1e-14)
    # D has a ridge of width α. Two rules that both miss it agree on a wrong value, so their
    # difference proves nothing. This term bounds what they may miss, from the rate of convergence.
    resolution = nodes * alpha
    hidden = jnp.minimum(1.0, 2 * (1 + resolution) * jnp.exp(-1.2 * resolution))
    # The roundings of u, h and S are absolute. Divisions by σ² and by α magnify them.
    rounding = np.finfo(float).eps * (4 / sigma_u**2 + 8 / alpha)
    error = estimate.error + hidden * (1 + jnp.abs(estimate.value)) + rounding
    return Estimate(estimate.value, error)


def sggx_quadrature(matrix: Matrix, theta_u: Scalar, phi: Scalar, *, nodes: int = 256) -> Estimate:
    """Return P_s of an SGGX matrix S (3, 3) by quadrature of its definition.

    `theta_u` and `phi` are the angles of the light in radians.
    """
    theta_u, phi = jnp.asarray(theta_u), jnp.asarray(phi)
    # Eigenvalues have no derivative where two are equal. None is needed: they only scale S, which
    # does not change P_s, and enter the error.
    least, _, largest = jnp.linalg.eigvalsh(jax.lax.stop_gradient(jnp.asarray(matrix)))
    matrix, alpha = matrix / largest, jnp.sqrt(least / largest)
    sigma_u = projected_area(matrix, direction(theta_u, phi))
    return fraction_by_quadrature(
        lambda h: normal_distribution(matrix, h), sigma_u, theta_u, phi, alpha, nodes
    )
