"""What a quantity gets that does not say how it is called: names, arguments, and its exact code."""

import re
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import jax
import jax.numpy as jnp

from integrals.reference import Axis
from programs.functions import Parameter, function
from programs.tracing.tracer import trace
from quantities.calling_convention import Argument, CallingConvention, clamped
from quantities.problem import ExactCode


def default_calling(
    name: str,
    axes: Sequence[Axis],
    symbol: str,
    shader: str = "",
    arguments: Mapping[str, str] | None = None,
) -> CallingConvention:
    """Return the convention that clamps all arguments to their domains, in the order of the axes.

    `name` is that of the quantity. `shader` is the name of the exported function; if it is empty,
    it is the name in capitals: 'my-lobe' gives MyLobe. `arguments` maps names of axes to those of
    the arguments. Raises ValueError if it names something else.
    """
    names, known = arguments or {}, [axis.name for axis in axes]
    for each in names:
        if each not in known:
            raise ValueError(f"arguments: {each!r} is no axis: allowed are {', '.join(known)}")
    capitals = "".join(part[:1].upper() + part[1:] for part in re.split(r"[^A-Za-z0-9]+", name))
    return CallingConvention(
        shader or capitals,
        f"{symbol}; clamps to the domain.",
        tuple(Argument(axis.name, names.get(axis.name, axis.name), "both") for axis in axes),
    )


def default_exact_code(
    calling: CallingConvention, closed: Callable[..., Any] | None, axes: Sequence[Axis]
) -> ExactCode | None:
    """Return a closed form as code; None if there is none, or if no shader could evaluate it."""
    if closed is None:
        return None

    def value(*given):
        pairs = zip(given, axes, strict=True)
        return jnp.asarray(closed(*(clamped(x, axis.lower, axis.upper) for x, axis in pairs)))

    names = {each.axis: each.name for each in calling.arguments}
    parameters = [Parameter(names[axis.name], (axis.lower, axis.upper), axis.unit) for axis in axes]
    made = function(f"{calling.name}Exact", parameters, value, "The closed form.")
    try:
        with jax.enable_x64(True):
            trace(made)
    except ValueError:
        return None
    return ExactCode("closed form", tuple(axes), lambda _: (made,), lambda points: (points,))
