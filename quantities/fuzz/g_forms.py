"""Forms of G: its limit for an infinitely dense layer times a factor that grows with density.

To within a few per cent G = F(ν) (1 − D(x)). F is the limit, which depends on ν = v·n alone. The
decay D falls from 1 to 0 as x grows: either e^(−x) or the fourth power of a rational function of x.
The rate x is about d/ν. F and x are rational functions.
"""

import functools
import itertools
from collections.abc import Callable, Iterator

import jax.numpy as jnp
import numpy as np
from jax import Array

from fitting.form import Form, Proofs, Stage, Wider, unguarded
from integrals import G
from integrals.reference import restricted
from shading.types import Scalar

AXES = restricted(G.axes, density=(0.001, 0.5), cos_v=(0.001, 1.0))

# A part of a form: the names of its coefficients, a function of them (and of d and ν), and a start.
Piece = tuple[tuple[str, ...], Callable, tuple[float, ...]]

# The rate x. It is close to d/ν for small d, because G = d/ν + O(d² ln d).
RATES: dict[str, Piece] = {
    "constant": (("1",), lambda c, d, nu: d * (1 / nu + c[0]), (2.4,)),
    "scaled": (("1", "1/ν"), lambda c, d, nu: d * (c[0] + c[1] / nu), (2.4, 1.0)),
    "pole": (
        ("1", "1/(b + ν + d)", "b"),
        lambda c, d, nu: d * (c[0] + c[1] / (c[2] + nu + d) + 1 / nu),
        (2.2, 0.1, 0.03),
    ),
}
# The factor F, the limit of G as d grows.
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

# The rate and the factor that have all others as special cases: x = d (c₀ + c₁/(c₂ + ν + d) + c₃/ν)
# and F = c₀ + c₁/(c₂ + ν (c₃ + c₄/(c₅ + ν))). They are not searched: they only evaluate the others.
# Of each special case there are the places of its coefficients, and the fixed ones. A pole without
# a numerator is farther away than any other, so that its divisor is never the least.
_FAR = 1e300
_WIDE_RATES = {
    "constant": ((0,), (0.0, 0.0, _FAR, 1.0)),
    "scaled": ((0, 3), (0.0, 0.0, _FAR, 1.0)),
    "pole": ((0, 1, 2), (0.0, 0.0, 1.0, 1.0)),
}
_WIDE_FACTORS = {
    "linear": ((3,), (0.0, 1.0, 1.0, 0.0, 0.0, _FAR)),
    "affine": ((2, 3), (0.0, 1.0, 0.0, 0.0, 0.0, _FAR)),
    "pole": ((0, 1, 2), (0.0, 0.0, 0.0, 1.0, 0.0, _FAR)),
    "inverse": ((3, 4, 5), (0.0, 1.0, 1.0, 0.0, 0.0, 1.0)),
}


def _widest_rate(c, d, nu):
    return d * (c[0] + c[1] / (c[2] + nu + d) + c[3] / nu)


def _widest_factor(c, nu):
    return c[0] + c[1] / (c[2] + nu * (c[3] + c[4] / (c[5] + nu)))


# The rates and factors as text. The coefficients of the factor begin at C[{0}].
_RATE_TEXTS = {
    "constant": "d·(1/ν + C[0])",
    "scaled": "d·(C[0] + C[1]/ν)",
    "pole": "d·(C[0] + C[1]/(C[2] + ν + d) + 1/ν)",
}
_FACTOR_TEXTS = {
    "linear": "1/(1 + C[{0}]·ν)",
    "affine": "1/(C[{0}] + C[{1}]·ν)",
    "pole": "C[{0}] + C[{1}]/(C[{2}] + ν)",
    "inverse": "1/(1 + ν·(C[{0}] + C[{1}]/(C[{2}] + ν)))",
}


@functools.cache
def decay_g(*, decay: str, rate: str, factor: str) -> Form:
    """Return the form F (1 − D(x)) with x of RATES, F of FACTORS and D of DECAYS.

    D is e^(−x) for 'exponential' and 1/(1 + ax + bx²)⁴ for 'power'. The coefficients are those of
    the rate, then those of the factor, then a and b of the power.
    """
    rate_names, rate_of, rate_start = RATES[rate]
    factor_names, factor_of, factor_start = FACTORS[factor]
    split = len(rate_names)
    power_names = ("x", "x²") if decay == "power" else ()
    power_start = (0.25, 0.03) if decay == "power" else ()

    def value(c, density: Scalar, cos_v: Scalar) -> Array:
        d, nu = jnp.asarray(density), jnp.asarray(cos_v)
        x = rate_of(c[:split], d, nu)
        F = factor_of(c[split : split + len(factor_names)], d, nu)
        return _decayed(decay, c, x, F)

    places = range(split, split + len(factor_names) + len(power_names))
    base = f"base = 1 + x·(C[{places[-2]}] + C[{places[-1]}]·x); " if decay == "power" else ""
    parts = {"rate": rate_names, "factor": factor_names, "decay": power_names}
    # This start is about right for small d and small ν. The fit also starts from multiples of it.
    start = np.array([*rate_start, *factor_start, *power_start])
    return Form(
        name="decay-g",
        equation=(
            f"x = {_RATE_TEXTS[rate]}; F = {_FACTOR_TEXTS[factor].format(*places)}; "
            f"{base}G = (1 − {'exp(−x)' if decay == 'exponential' else '1/base⁴'})·F"
        ),
        reference=G,
        axes=AXES,
        coefficient_names=[f"{part}: {name}" for part, names in parts.items() for name in names],
        stages=(Stage(value),),
        starts=(start, start * 1.3, start * 0.75),
        shape={"decay": decay, "rate": rate, "factor": factor},
        wider=_wider(decay, rate, factor),
    )


def _decayed(decay: str, c, x, F):
    if decay == "exponential":
        return (1 - jnp.exp(-x)) * F
    base = 1 + x * (c[-2] + c[-1] * x)
    square = base * base
    return (1 - 1 / (square * square)) * F


def _wider(decay: str, rate: str, factor: str) -> Wider:
    """Return the form with the widest rate and factor, and where the coefficients are in it."""
    (rate_places, rate_fixed), (places, fixed) = _WIDE_RATES[rate], _WIDE_FACTORS[factor]
    of_power = (0.0, 0.0) if decay == "power" else ()
    first, last = len(rate_fixed), len(rate_fixed) + len(fixed)
    return Wider(
        _widest(decay),
        (*rate_places, *(first + k for k in places), *range(last, last + len(of_power))),
        (*rate_fixed, *fixed, *of_power),
    )


@functools.cache
def _widest(decay: str) -> Form:
    def value(c, density: Scalar, cos_v: Scalar) -> Array:
        d, nu = jnp.asarray(density), jnp.asarray(cos_v)
        return _decayed(decay, c, _widest_rate(c[:4], d, nu), _widest_factor(c[4:10], nu))

    return Form(
        name="widest-decay-g",
        equation="all decays of one kind",
        reference=G,
        axes=AXES,
        coefficient_names=[f"c{k}" for k in range(12 if decay == "power" else 10)],
        stages=(Stage(value),),
    )


@functools.cache
def tied_g(*, poles: int, root: int) -> Form:
    """Return a form of G that has the exact slope 1/ν at d = 0 and the exact value 1 at ν = 0.

    The form is (1 − e^(−d (1/ν + w)/(1 + c√d))) / (1 + νw). The rate and the factor share w(ν),
    which is a constant, plus a pole if `poles` is 1. The divisor 1 + c√d is there only if `root` is
    1. The coefficients are those of w, then c.
    """
    places = (0, *((1, 2) if poles else ()), *((3,) if root else ()))
    return _tied_form(poles, root, Wider(_widest_tie(), places, (0.0, 0.0, 1.0, 0.0)))


def _tied_form(poles: int, root: int, wider: Wider | None) -> Form:
    def value(c, density: Scalar, cos_v: Scalar) -> Array:
        d, nu = jnp.asarray(density), jnp.asarray(cos_v)
        w = c[0] + c[1] / (c[2] + nu) if poles else c[0]
        thin = d * (1 / nu + w)
        x = thin / (1 + c[-1] * jnp.sqrt(d)) if root else thin
        return (1 - jnp.exp(-x)) / (1 + nu * w)

    # For an infinitely dense layer G is about 1/(1 + 3ν). The fit also starts from 1.3 times this.
    first = np.array([2.5, *((0.1, 0.05) if poles else ()), *((0.1,) if root else ())])
    return Form(
        name="tied-g",
        equation=(
            f"w = a0{' + a1/(b + ν)' if poles else ''}; "
            f"x = d·(1/ν + w){'/(1 + c·√d)' if root else ''}; G = (1 − exp(−x))/(1 + ν·w)"
        ),
        reference=G,
        axes=AXES,
        coefficient_names=["a0", *(("a1", "b") if poles else ()), *(("c: √d",) if root else ())],
        stages=(Stage(value),),
        starts=(first, first * 1.3),
        shape={"poles": poles, "root": root},
        proofs=Proofs(positive=unguarded),
        wider=wider,
    )


@functools.cache
def _widest_tie() -> Form:
    return _tied_form(1, 1, None)


def candidates() -> Iterator[Form]:
    """Yield the forms of G that a search tries."""
    for decay, rate, factor in itertools.product(DECAYS, RATES, FACTORS):
        yield decay_g(decay=decay, rate=rate, factor=factor)
    for poles, root in itertools.product(range(2), range(2)):
        yield tied_g(poles=poles, root=root)
