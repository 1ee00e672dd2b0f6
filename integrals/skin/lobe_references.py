"""The references of the light that a single Gaussian scatters on a cylinder and on a sphere.

The arguments are the cosine of normal and light, which may be negative, and the Gaussian's width
σ/r. Any sum of Gaussians is a mean of these lobes (`integrals.skin.scattering`).
"""

import jax.numpy as jnp

from integrals.reference import Axis, Estimate, Reference, leg
from integrals.sampling import Sampling
from integrals.skin.lobes import ring_lobe, sphere_lobe
from integrals.skin.references import COSINE, angle_of
from integrals.skin.sampling import ring_by_sampling, sphere_by_sampling

WIDTH = Axis(
    "width", 0.0, 4.0, "s", meaning="width of the Gaussian by the radius, σ/r", scale="square"
)
# Nodes of the quadrature, for which the values differ by 2e-14 from those with three times as many.
_NODES, _ERROR = 32, 1e-13
_SURFACES = {
    "cylinder": (ring_lobe, ring_by_sampling),
    "sphere": (sphere_lobe, sphere_by_sampling),
}


def lobe_reference(surface: str) -> Reference:
    """Return the reference of a lobe on 'cylinder' or 'sphere'."""
    lobe, by_sampling = _SURFACES[surface]

    @leg(COSINE, WIDTH)
    def quadrature(cosine, width) -> Estimate:
        return Estimate(lobe(angle_of(cosine), width, nodes=_NODES), jnp.full((), _ERROR))

    @leg(COSINE, WIDTH)
    def monte_carlo(cosine, width, **options) -> Estimate:
        found = by_sampling(angle_of(cosine), width, **options)
        return Estimate(found.value, found.error + _ERROR)

    return Reference(
        name=f"skin-lobe-{surface}",
        symbol="D",
        meaning=f"light that a Gaussian profile scatters on a {surface}",
        definition="∫ e^(−|x − y|²/2σ²) max(0, n(y)·l) dy / ∫ e^(−|x − y|²/2σ²) dy",
        axes=(COSINE, WIDTH),
        sampling=Sampling(fitted=11, checked=13, judged=14, verified=1 << 12),
        quadrature=quadrature,
        monte_carlo=monte_carlo,
        batch=1024,
    )


SKIN_LOBES = (lobe_reference("cylinder"), lobe_reference("sphere"))
