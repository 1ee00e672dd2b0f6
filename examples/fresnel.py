"""Average reflectance of a dielectric, F_avg(η) = 2 ∫ F(μ, η) μ dμ, and forms that approximate it.

shadefit search -p examples/fresnel.py fresnel --out /tmp/fresnel
shadefit refit -p examples/fresnel.py --norm linf --out /tmp/tables
shadefit export -p examples/fresnel.py /tmp/tables/fresnel.json --to hlsl
"""

import jax.numpy as jnp

import shadefit as sf


def reflectance(mu, eta):
    """Fresnel's reflectance of unpolarised light at cosine μ, from outside."""
    g = jnp.sqrt(eta * eta - (1 - mu) * (1 + mu))
    s = (g - mu) / (g + mu)
    p = (mu * (g + mu) - 1) / (mu * (g - mu) + 1)
    return s * s * (1 + p * p) / 2


FRESNEL = sf.make_reference(
    # μ = t²: near η = 1, F rises steeply towards grazing light.
    sf.quadrature(lambda t, eta: 4 * t**3 * reflectance(t * t, eta), over=[(0, 1)]),
    name="fresnel",
    axes=[sf.Axis("eta", 1.0, 3.0, "η", meaning="index of refraction, inside over outside")],
    symbol="F_avg",
    definition="2 ∫ F(μ, η) μ dμ",
    meaning="cosine-weighted average of a dielectric's reflectance",
)


def kulla_conty(eta, c0, c1):
    """(η − 1)/(c0 + c1 η), the form of Kulla and Conty 2017"""
    return (eta - 1) / (c0 + c1 * eta)


def quotient(eta, a0, a1, b1, b2):
    """z (a0 + a1 z)/(1 + z (b1 + b2 z)), z = η − 1"""
    z = eta - 1
    return z * (a0 + a1 * z) / (1 + z * (b1 + b2 * z))


PROBLEM = sf.Problem(
    reference=FRESNEL,
    default=sf.plain_form(quotient, FRESNEL),
    forms=(sf.plain_form(kulla_conty, FRESNEL, start=[4.0, 1.0]),),
    calling=sf.CallingConvention(
        name="FresnelAverage",
        summary="F_avg by {equation}; clamps to the domain.",
        arguments=(sf.Argument("eta", "eta", clamp="both"),),
    ),
)
