"""A quantity of one's own: S = tanh(x y), and two forms that approximate it.

shadefit refit -p examples/soft_step.py --norm linf --out /tmp/tables
shadefit export -p examples/soft_step.py /tmp/tables/soft.json --to hlsl
"""

import jax.numpy as jnp

import shadefit as sf

AXES = (sf.Axis("x", 0.0, 4.0, meaning="argument"), sf.Axis("y", 0.5, 1.0, meaning="scale"))


@sf.leg(*AXES)
def closed_form(x, y):
    return sf.Estimate(jnp.tanh(x * y), jnp.full((), 4e-16))


SOFT = sf.Reference(
    name="soft",
    symbol="S",
    meaning="a soft step",
    definition="tanh(x y)",
    axes=AXES,
    sampling=sf.Sampling(fitted=9, checked=10, judged=11),
    closed_form=closed_form,
)


def short(x, y, a, b):
    """S = a z/(1 + b z²), z = x y"""
    z = x * y
    return a * z / (1 + b * z * z)


def longer(x, y, a, b, c):
    """S = z (a + c z²)/(1 + b z²), z = x y"""
    z = x * y
    return z * (a + c * z * z) / (1 + b * z * z)


FORMS = (sf.plain_form(short, SOFT), sf.plain_form(longer, SOFT, start=[1.0, 0.4, 0.1]))
PROBLEM = sf.Problem(
    reference=SOFT,
    default=FORMS[1],
    forms=FORMS[:1],
    calling=sf.CallingConvention(
        name="SoftStep",
        summary="S ({equation}); clamps to the domain.",
        arguments=(sf.Argument("x", "x", clamp="both"), sf.Argument("y", "y", clamp="both")),
    ),
)
