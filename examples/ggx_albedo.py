"""Directional albedo of GGX, E(μ, α) = ∫ f (l·n) dl with Smith's height-correlated masking.

shadefit refit -p examples/ggx_albedo.py --norm linf --rounding float16 --out /tmp/tables
shadefit compare -p examples/ggx_albedo.py /tmp/tables/ggx-albedo.json
shadefit export -p examples/ggx_albedo.py /tmp/tables/ggx-albedo.json --to glsl
"""

import jax.numpy as jnp

from shadefit import Axis, Problem, Published, powers, quadrature


def integrand(nu, mu, alpha):
    """The integral over the azimuth is elementary: this is what is left, by ν = l·n."""
    k, w = (1 - alpha) * (1 + alpha), mu + nu
    q = (k * nu - (1 + alpha**2) * mu) ** 2 + 4 * alpha**2 * (1 - mu) * (1 + mu)
    a = 2 * alpha**2 * (1 + mu * nu) + k * ((1 - mu) * (1 + mu) + (1 - nu) * (1 + nu))
    azimuth = 1 + 2 * k * w / jnp.sqrt(q) + k**2 * w * a / q**1.5
    sigma_mu, sigma_nu = (jnp.sqrt(alpha**2 + k * x * x) for x in (mu, nu))
    return alpha**2 * nu / (mu * sigma_nu + nu * sigma_mu) * azimuth


albedo = Problem(
    "ggx-albedo",
    axes=[
        Axis("mu", 0.02, 1, "μ", meaning="v·n"),
        Axis("alpha", 0.05, 1, "α", meaning="width of GGX, perceptual roughness squared"),
    ],
    # The integrand is steep near ν = 0 and near the mirror direction ν = μ.
    reference=quadrature(integrand, over=[(0, 1)], breaks=(lambda mu, alpha: mu,)),
    symbol="E",
    definition="∫ f(v, l) (l·n) dl",
    meaning="directional albedo of GGX without Fresnel reflectance",
    codomain=(0, 1),
    published=[
        Published(
            "materialx",
            # The numerators and denominators of A, then those of B, by the monomials below.
            [
                *(0.1003, -0.6303, 9.748, -2.038, 29.34, -8.245, -26.44, 19.99, -5.448),
                *(1, -1.765, 8.263, 11.53, 28.96, -7.507, -36.11, 15.86, 33.37),
                *(0.9345, -2.323, 2.229, -3.748, 1.424, -0.7684, 1.436, 0.2913, 0.6286),
                *(1, 0.2281, 15.94, -55.83, 13.08, 41.26, 54.9, 300.2, -285.1),
            ],
            "MaterialX, GGX directional albedo, A + B at reflectance 1",
        )
    ],
    shader="GgxAlbedo",
    arguments={"mu": "NdotV"},
)
albedo.rational(powers(2, 2), powers(2, 2), one=(0, 1), name="biquadratic")


@albedo.form(sizes={"c": 36})
def materialx(mu, alpha, c):
    """A + B, A = (c₀ + c₁ μ + c₂ α + c₃ μα + c₄ μ² + …)/(c₉ + …), B the same with c₁₈ to c₃₅"""
    t = jnp.stack([1, mu, alpha, mu * alpha, mu**2, alpha**2])
    t = jnp.concatenate([t, jnp.stack([mu**2 * alpha, mu * alpha**2, mu**2 * alpha**2])])
    a, b = (c[0:9] @ t) / (c[9:18] @ t), (c[18:27] @ t) / (c[27:36] @ t)
    return jnp.clip(a, 0, 1) + jnp.clip(b, 0, 1)
