"""A function of two arguments, S = tanh(x y), and two forms that approximate it.

shadefit refit -p examples/soft_step.py --norm linf --out /tmp/tables
shadefit export -p examples/soft_step.py /tmp/tables/soft.json --to hlsl
"""

import jax.numpy as jnp

from shadefit import Axis, Problem, closed_form

soft = Problem(
    "soft",
    axes=[Axis("x", 0, 4, meaning="argument"), Axis("y", 0.5, 1, meaning="scale")],
    reference=closed_form(lambda x, y: jnp.tanh(x * y)),
    symbol="S",
    definition="tanh(x y)",
    meaning="a soft step",
    codomain=(0, 1),
    shader="SoftStep",
)


@soft.form(start=[1.0, 0.4, 0.1])
def longer(x, y, a, b, c):
    """S = z (a + c z²)/(1 + b z²), z = x y"""
    z = x * y
    return z * (a + c * z * z) / (1 + b * z * z)


@soft.form
def short(x, y, a, b):
    """S = a z/(1 + b z²), z = x y"""
    z = x * y
    return a * z / (1 + b * z * z)
