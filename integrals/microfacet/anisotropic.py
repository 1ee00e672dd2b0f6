"""The reference of the directional albedo of an anisotropic GGX surface with F = 1."""

import math

import jax.numpy as jnp

from integrals.microfacet.monte_carlo import albedo_by_sampling
from integrals.microfacet.visible_ellipse import AZIMUTHS, NODES, anisotropic_albedo
from integrals.monte_carlo import Sequence
from integrals.reference import Axis, Estimate, Reference, leg
from integrals.sampling import Sampling
from shading.directions import direction

AXES = (
    Axis("alpha_x", 0.05, 1.0, "αx", meaning="width of GGX along x", scale="logarithmic"),
    Axis("alpha_y", 0.05, 1.0, "αy", meaning="width of GGX along y", scale="logarithmic"),
    Axis("theta_v", 0.0, math.pi / 2, "θv", "rad", "angle of the view with the normal"),
    Axis("phi", 0.0, math.pi, "φ", "rad", "azimuth of the view from the x axis", period=math.pi),
)


@leg(*AXES)
def quadrature(
    alpha_x, alpha_y, theta_v, phi, *, nodes: int = NODES, azimuths: int = AZIMUTHS
) -> Estimate:
    """Integrate over the ellipse of the normals that reflect the view above the horizon."""
    # The closest sine and cosine of π/2 would be below the horizon by a rounding.
    view = direction(theta_v, phi)
    view = view.at[2].set(jnp.maximum(view[2], 0.0))
    widths = jnp.stack([alpha_x, alpha_y])
    return anisotropic_albedo(view, widths, nodes=nodes, azimuths=azimuths)


@leg(*AXES)
def monte_carlo(
    alpha_x,
    alpha_y,
    theta_v,
    phi,
    *,
    samples: int = 1 << 16,
    sequence: Sequence = "random",
    seed: int = 0,
) -> Estimate:
    """Draw visible normals and average what each returns."""
    widths = jnp.stack([alpha_x, alpha_y])
    return albedo_by_sampling(
        direction(theta_v, phi), widths, samples=samples, sequence=sequence, seed=seed
    )


ANISOTROPIC_ALBEDO = Reference(
    name="ggx-anisotropic-albedo",
    symbol="E",
    meaning="directional albedo of anisotropic GGX without Fresnel reflectance",
    definition="∫_Ω f(v, l) (l·n) dω_l",
    axes=AXES,
    sampling=Sampling(fitted=10, checked=10, judged=11, climbs=False, verified=1 << 11),
    quadrature=quadrature,
    monte_carlo=monte_carlo,
    batch=4,
)
