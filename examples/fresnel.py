"""Average reflectance of a dielectric, F_avg(η) = 2 ∫ F(μ, η) μ dμ, and forms that approximate it.

shadefit refit -p examples/fresnel.py --form rational-3-1 --norm linf --out /tmp/tables
shadefit export -p examples/fresnel.py /tmp/tables/fresnel-rational-3-1.json --to hlsl
shadefit search -p examples/fresnel.py fresnel --out /tmp/fresnel
"""

import jax.numpy as jnp

from shadefit import Axis, Problem, Published, powers, quadrature


def reflectance(mu, eta):
    g = jnp.sqrt(eta * eta - (1 - mu) * (1 + mu))
    s = (g - mu) / (g + mu)
    p = (mu * (g + mu) - 1) / (mu * (g - mu) + 1)
    return s * s * (1 + p * p) / 2


fresnel = Problem(
    "fresnel",
    axes=[Axis("eta", 1.0, 3.0, "η", meaning="index of refraction, inside over outside")],
    # μ = t²: near η = 1, F rises steeply towards grazing light
    reference=quadrature(lambda t, eta: 4 * t**3 * reflectance(t * t, eta), over=[(0, 1)]),
    symbol="F_avg",
    definition="2 ∫ F(μ, η) μ dμ",
    meaning="cosine-weighted average of a dielectric's Fresnel reflectance",
    published=[Published("kulla-conty", [4.08567, 1.00071], "Kulla and Conty 2017")],
    shader="FresnelAverage",
)


@fresnel.form
def kulla_conty(eta, c0, c1):
    """(η − 1)/(c0 + c1 η)"""
    return (eta - 1) / (c0 + c1 * eta)


for above in range(1, 4):
    for below in range(1, 4):
        fresnel.rational(
            powers(above)[1:],
            powers(below),
            name=f"rational-{above}-{below}",
            of=lambda eta: eta - 1,
        )
