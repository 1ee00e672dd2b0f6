"""A sphere of rough metal under lamps at infinity, for any isotropic NDF, without noise.

An image shows the NDF itself: the light of a lamp is D(h) G2/(4μν) times Fresnel's factor, and what
Kulla and Conty return of the light that single scattering loses. G2 and the directional albedo E
are those of the NDF.
"""

from collections.abc import Callable
from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from integrals.microfacet import directional_albedo as ggx_albedo
from integrals.piecewise.albedo import directional_albedo
from integrals.piecewise.smith import hidden_area
from shadefit.render.scenes import SCENES
from shadefit.render.shade import BACKDROP
from shading.microfacet import color_of_walk, projected_roughness_at, schlick
from shading.piecewise.ndf import Profile, density

# E is interpolated between these polar angles, and constant beyond the last one.
_ANGLES = np.linspace(0.0, 1.565, 80)
# Directions of the lamps (to be normalised), and their irradiances in linear RGB.
LAMPS = (
    ((-0.6, -0.7, 0.8), (1.5, 1.4, 1.25)),
    ((0.9, -0.2, 0.25), (0.35, 0.5, 0.7)),
    ((0.1, 0.95, 0.45), (0.5, 0.45, 0.4)),
)


@dataclass(frozen=True, eq=False)
class Microfacets:
    """An isotropic NDF for the sphere.

    `density` maps the sine and the cosine of the half vector's polar angle (n,) to D, `hidden` a
    cosine (n,) to H = Λ times the cosine. `albedos` is E at the polar angles of the table.
    """

    density: Callable[[Array, Array], Array]
    hidden: Callable[[Array], Array]
    albedos: np.ndarray

    def albedo(self, cosine: Array) -> Array:
        """Return E at cosines (n,)."""
        return jnp.interp(jnp.arccos(jnp.clip(cosine, 0.0, 1.0)), _ANGLES, self.albedos)

    @property
    def average(self) -> float:
        """E_avg = 2 ∫ E μ dμ of the interpolated E."""
        theta = np.linspace(0, np.pi / 2, 4001)
        values = np.interp(theta, _ANGLES, self.albedos) * np.sin(2 * theta)
        return float(np.trapezoid(values, theta))


def ggx_microfacets(alpha: float) -> Microfacets:
    """Return GGX of the width α."""
    albedos = jax.jit(jax.vmap(lambda theta: ggx_albedo(jnp.cos(theta), alpha).value))(_ANGLES)

    def of(sine, cosine):
        below = (sine / alpha) ** 2 + cosine * cosine
        return 1 / (np.pi * alpha**2 * below * below)

    def hidden(cosine):
        return (projected_roughness_at(cosine, alpha) - cosine) / 2

    return Microfacets(of, jax.vmap(hidden), np.asarray(albedos))


def piecewise_microfacets(ndf: Profile) -> Microfacets:
    """Return a piecewise-linear NDF. Raises ValueError if it is not linear in cos²θ."""
    albedos = jax.jit(lambda at: jax.lax.map(lambda theta: directional_albedo(ndf, theta), at))

    def of(sine, cosine):
        return density(ndf, jnp.arctan2(sine, cosine))

    hidden = jax.vmap(lambda cosine: hidden_area(ndf, jnp.arccos(cosine)))
    return Microfacets(of, hidden, np.asarray(albedos(jnp.asarray(_ANGLES))))


def lit_sphere(
    microfacets: Microfacets,
    reflectance: tuple[float, float, float],
    *,
    size: int = 128,
    multiple: bool = True,
    lamps: tuple = LAMPS,
) -> np.ndarray:
    """Return the linear radiance (size, size, 3) of a sphere of metal.

    `reflectance` is that at normal incidence in linear RGB. Without `multiple` there is single
    scattering only. `lamps` are pairs of a direction to a lamp and its irradiance.
    """
    hits = SCENES["sphere"].hits(size)
    axes = np.array([axis for axis, _ in lamps], float)
    axes /= np.linalg.norm(axes, axis=1, keepdims=True)
    radiance = np.array([each for _, each in lamps], float)
    total = jnp.zeros((size * size, 3))
    for axis, irradiance in zip(axes, radiance, strict=True):
        reflected = _reflected(
            microfacets,
            jnp.asarray(hits.normal),
            jnp.asarray(hits.view),
            jnp.asarray(axis),
            jnp.asarray(reflectance),
            float(multiple),
        )
        total = total + reflected * jnp.asarray(irradiance)
    image = np.where(hits.seen[:, None], np.asarray(total), BACKDROP)
    return image.reshape(size, size, 3)


def _reflected(microfacets: Microfacets, normals, views, light, f0, multiple) -> Array:
    """Return f ν (n, 3) of one lamp at n points."""

    @jax.jit
    def of(normals, views):
        mu = jnp.clip(jnp.sum(normals * views, axis=1), 1e-4, 1.0)
        nu = normals @ light
        lit, safe = nu > 0, jnp.clip(nu, 1e-4, 1.0)
        half = views + light
        half = half / jnp.linalg.norm(half, axis=1, keepdims=True)
        across = jnp.linalg.norm(jnp.cross(normals, half), axis=1)
        level = jnp.maximum(jnp.sum(normals * half, axis=1), 0.0)
        area_v, area_l = microfacets.hidden(mu), microfacets.hidden(safe)
        single = microfacets.density(across, level)
        single = single / (4 * (mu * safe + area_v * safe + area_l * mu))
        cosine = jnp.clip(half @ light, 0.0, 1.0)
        fresnel = jax.vmap(jax.vmap(schlick, (None, 0)), (0, None))(cosine, f0)
        average = microfacets.average
        missing = (1 - microfacets.albedo(mu)) * (1 - microfacets.albedo(safe))
        color = jax.vmap(color_of_walk, (0, None))((1 + 20 * f0) / 21, average)
        more = multiple * missing[:, None] * color / (np.pi * (1 - average))
        return jnp.where(lit, safe, 0.0)[:, None] * (fresnel * single[:, None] + more)

    return of(normals, views)
