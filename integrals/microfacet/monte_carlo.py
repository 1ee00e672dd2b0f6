"""The directional albedo of GGX by Monte Carlo: isotropic or not, with any Fresnel reflectance.

Normals are drawn as SGGX draws microflakes, from the whole ellipsoid whose upper half are the
facets. A visible flake of the lower half reflects light down, so it counts nothing.
"""

import jax
import jax.numpy as jnp

from integrals.microfacet.visible_ellipse import Fresnel, white
from integrals.monte_carlo import Sequence, mean_estimate, unit_points
from integrals.reference import Estimate
from shading.microfacet.ggx import Roughness, projected_roughness, widths
from shading.sggx import reflect, visible_normal
from shading.types import Scalar, Vector

# Between this and 0, E changes by 1e-10 at most.
_LEAST_MU = 1e-12


def albedo_by_sampling(
    view: Vector,
    alpha: Roughness,
    *,
    fresnel: Fresnel = white,
    samples: int = 1 << 16,
    sequence: Sequence = "random",
    seed: int = 0,
) -> Estimate:
    """Return the albedo for a unit vector o = `view` with o·n > 0, and its standard error.

    `alpha` is α or (αx, αy), and `fresnel` maps the cosine o·h to a reflectance. Lights are drawn
    with the density D(h)/(4σ(o)), so that each counts F 2νσ(o)/(μσ(i) + νσ(o)).
    """
    view = jnp.asarray(view, dtype=float)
    root = jnp.diag(jnp.append(widths(alpha), 1.0))
    sigma = projected_roughness(view, alpha)

    def returned(point):
        normal = visible_normal(root, view, point)
        light = reflect(view, normal)
        nu = jnp.maximum(light[2], 0.0)
        across = view[2] * projected_roughness(light, alpha) + nu * sigma
        return fresnel(view @ normal) * 2 * nu * sigma / across

    return mean_estimate(jax.vmap(jax.vmap(returned))(unit_points(samples, 2, sequence, seed)))


def directional_albedo_by_sampling(
    mu: Scalar,
    alpha: Scalar,
    *,
    fresnel: Fresnel = white,
    samples: int = 1 << 16,
    sequence: Sequence = "random",
    seed: int = 0,
) -> Estimate:
    """Return the albedo of an isotropic surface and its standard error; E(μ, α) by default."""
    # At μ = 0 a light on the horizon would count 0/0. The albedo is continuous there.
    mu = jnp.maximum(jnp.asarray(mu, dtype=float), _LEAST_MU)
    view = jnp.stack([jnp.sqrt((1 - mu) * (1 + mu)), jnp.zeros(()), mu])
    return albedo_by_sampling(
        view, alpha, fresnel=fresnel, samples=samples, sequence=sequence, seed=seed
    )
