"""A sixth quantity, declared as a user would: S = tanh(x y), and two forms that stand for it."""

import jax.numpy as jnp
import numpy as np

import shadefit as sf

AXES = (sf.Axis("x", "x", "1", 0.0, 4.0, "argument"), sf.Axis("y", "y", "1", 0.5, 1.0, "scale"))


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


def form(name: str, names: list[str], value) -> sf.Form:
    start = np.array([1.0, 0.4, 0.1][: len(names)])
    return sf.Form(
        name, f"{name} of z = x y", SOFT, AXES, names, (sf.Stage(value),), starts=(start,)
    )


def short(c, x, y):
    z = x * y
    return c[0] * z / (1 + c[1] * z * z)


def longer(c, x, y):
    z = x * y
    return z * (c[0] + c[2] * z * z) / (1 + c[1] * z * z)


FORMS = (form("short", ["a", "c"], short), form("longer", ["a", "c", "b"], longer))
PROBLEM = sf.Problem(
    reference=SOFT,
    default=FORMS[1],
    forms=FORMS[:1],
    candidates=lambda _: iter(FORMS),
    calling=sf.CallingConvention(
        name="SoftStep",
        summary="S ({equation}); clamps to the domain.",
        arguments=(sf.Argument("x", "x", clamp="both"), sf.Argument("y", "y", clamp="both")),
    ),
)
