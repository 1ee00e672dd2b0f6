"""A small quantity with a closed form, and forms of it: tests of fits that need no integral."""

from collections.abc import Callable

import jax.numpy as jnp

from fitting import Form, Stage
from integrals import Axis, Estimate, Reference, Sampling

AXES = (
    Axis("x", 0.0, 1.0, meaning="the first argument"),
    Axis("y", -1.0, 2.0, meaning="the second argument"),
)


def closed_form(x, y) -> Estimate:
    """Return e^(−x) (2 + sin y), and a bound on its rounding."""
    return Estimate(jnp.exp(-x) * (2 + jnp.sin(y)), jnp.full((), 1e-15))


TOY = Reference(
    name="toy",
    symbol="f",
    meaning="a smooth function of two arguments",
    definition="e^(−x) (2 + sin y)",
    axes=AXES,
    sampling=Sampling(fitted=7, checked=8, judged=9),
    closed_form=closed_form,
)


def toy_form(call: Callable, names: list, **options) -> Form:
    """Return a form of the toy quantity: `call` takes the coefficients, x and y."""
    return Form(
        name=options.pop("name", "toy-form"),
        equation="a toy",
        reference=TOY,
        axes=options.pop("axes", AXES),
        coefficient_names=names,
        stages=(Stage(call),),
        **options,
    )


PLANE = toy_form(
    lambda c, x, y: jnp.asarray(c[0] + c[1] * x + c[2] * y), ["1", "x", "y"], name="plane"
)
QUOTIENT = toy_form(
    lambda c, x, y: jnp.asarray((c[0] + c[1] * x + c[2] * y) / (1 + c[3] * x + c[4] * y * y)),
    ["1", "x", "y", "below: x", "below: y²"],
    name="quotient",
)
