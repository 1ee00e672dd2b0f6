"""Forms of G: what a layer of finite density keeps of the light that an infinite one returns.

To within a few per cent G = F(ν) (1 − e^(−d/ν …)). The exponent's rate and the factor F, of ν
alone, are rational. The power 1/(1 + x)⁴ may stand for the exponential.
"""

import functools
from collections.abc import Callable
from dataclasses import replace
from typing import ClassVar

import jax.numpy as jnp
import numpy as np
from jax import Array

from fitting.form import Form
from integrals import G
from shading.types import Scalar

AXES = (replace(G.axes[0], lower=0.001, upper=0.5), replace(G.axes[1], lower=0.001))

Piece = tuple[tuple[str, ...], Callable, tuple[float, ...]]

# How fast 1 − e^(−x) grows: x, with names of its coefficients and a start. G = d/ν + … for small d.
RATES: dict[str, Piece] = {
    "constant": (("1",), lambda c, d, nu: d * (1 / nu + c[0]), (2.4,)),
    "scaled": (("1", "1/ν"), lambda c, d, nu: d * (c[0] + c[1] / nu), (2.4, 1.0)),
    "pole": (
        ("1", "1/(b + ν + d)", "b"),
        lambda c, d, nu: d * (c[0] + c[1] / (c[2] + nu + d) + 1 / nu),
        (2.2, 0.1, 0.03),
    ),
}
# What G tends to as d grows.
FACTORS: dict[str, Piece] = {
    "linear": (("ν",), lambda c, d, nu: 1 / (1 + c[0] * nu), (2.9,)),
    "affine": (("1", "ν"), lambda c, d, nu: 1 / (c[0] + c[1] * nu), (1.0, 2.9)),
    "pole": (("1", "1/(b + ν)", "b"), lambda c, d, nu: c[0] + c[1] / (c[2] + nu), (0.1, 0.3, 0.3)),
    "inverse": (
        ("ν", "ν/(b + ν)", "b"),
        lambda c, d, nu: 1 / (1 + nu * (c[0] + c[1] / (c[2] + nu))),
        (2.5, 0.1, 0.03),
    ),
}
DECAYS = ("exponential", "power")


@functools.cache
def decay_g(*, decay: str, rate: str, factor: str) -> type[Form]:
    """Give the form of G with a rate of RATES, a factor of FACTORS, and a decay of DECAYS."""
    rate_names, rate_of, rate_start = RATES[rate]
    factor_names, factor_of, factor_start = FACTORS[factor]
    split = len(rate_names)
    power_names = ("x", "x²") if decay == "power" else ()

    class DecayG(Form):
        """G̃ = F (1 − D(x)); `coefficients`: of the rate x, of the factor F, of the decay D."""

        name = "decay-g"
        equation = (
            f"G = F(ν) (1 − {'e^(−x)' if decay == 'exponential' else '1/(1 + ax + bx²)⁴'}), "
            f"rate x {rate}, factor F {factor}"
        )
        integral = G
        axes = AXES
        shape: ClassVar = {"decay": decay, "rate": rate, "factor": factor}

        def __call__(self, density: Scalar, cos_v: Scalar) -> Array:
            """Evaluate G̃ at one density and one cosine of the view."""
            d, nu = jnp.asarray(density), jnp.asarray(cos_v)
            c = self.coefficients
            x = rate_of(c[:split], d, nu)
            f = factor_of(c[split : split + len(factor_names)], d, nu)
            if decay == "exponential":
                return (1 - jnp.exp(-x)) * f
            base = 1 + x * (c[-2] + c[-1] * x)
            square = base * base
            return (1 - 1 / (square * square)) * f

        @classmethod
        def coefficient_names(cls) -> list:
            """Name the coefficients by part and by what they multiply."""
            parts = {"rate": rate_names, "factor": factor_names, "decay": power_names}
            return [f"{part}: {name}" for part, names in parts.items() for name in names]

        @classmethod
        def starts(cls) -> list[np.ndarray]:
            """Give starts: the leading behaviour, with corrections of several sizes."""
            power = (0.25, 0.03) if decay == "power" else ()
            start = np.array([*rate_start, *factor_start, *power])
            return [start, start * 1.3, start * 0.75]

    return DecayG


@functools.cache
def tied_g(*, poles: int, root: int) -> type[Form]:
    """Give the form of G that is d/ν + … for small d and one at ν = 0, both exactly.

    The rate and the factor share w(ν): a constant and `poles` (0 or 1); `root` = 1 slows the rate
    by 1/(1 + c√d).
    """

    class TiedG(Form):
        """G̃ = (1 − e^(−d (1/ν + w)/(1 + c√d))) / (1 + νw); `coefficients`: of w, then c."""

        name = "tied-g"
        equation = (
            f"G = (1 − e^(−d (1/ν + w){' / (1 + c √d)' if root else ''})) / (1 + ν w), "
            f"w = {'a₀ + a₁/(b + ν)' if poles else 'a₀'}"
        )
        integral = G
        axes = AXES
        shape: ClassVar = {"poles": poles, "root": root}

        def __call__(self, density: Scalar, cos_v: Scalar) -> Array:
            """Evaluate G̃ at one density and one cosine of the view."""
            d, nu, c = jnp.asarray(density), jnp.asarray(cos_v), self.coefficients
            w = c[0] + c[1] / (c[2] + nu) if poles else c[0]
            x = d * (1 / nu + w)
            if root:
                x = x / (1 + c[-1] * jnp.sqrt(d))
            return (1 - jnp.exp(-x)) / (1 + nu * w)

        @classmethod
        def coefficient_names(cls) -> list:
            """Name the coefficients by what they multiply."""
            return ["a0", *(("a1", "b") if poles else ()), *(("c: √d",) if root else ())]

        @classmethod
        def starts(cls) -> list[np.ndarray]:
            """Give starts: an infinite layer's 1/(1 + 3ν), with corrections of several sizes."""
            first = [2.5, *((0.1, 0.05) if poles else ()), *((0.1,) if root else ())]
            return [np.array(first), np.array(first) * 1.3]

    return TiedG
