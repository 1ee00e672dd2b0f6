"""Forms of the light on curved skin: hyperbolas in the cosine, with rational functions of κ.

q = √(c² + (aκ)²) is |c| with a rounded kink, whose width is proportional to the curvature κ. With a
second, wider one Q the form is D = (c + q)/2 + N/B, where the sum N has monomials of κ times 1, c,
c², c⁴, q and p = Q − q. p vanishes at κ = 0. All other terms have a factor κ, so the form is
exactly max(0, c) at κ = 0, whatever its coefficients.
"""

import functools
from collections.abc import Iterator
from typing import Any

import jax.numpy as jnp
from jax import Array

from fitting.equation import equation_of
from fitting.form import Form, Stage
from fitting.shapes.monomial_sums import ONE, coefficient_name, nested_horner, sum_text
from fitting.shapes.monomials import Exponents
from integrals.reference import Reference, restricted
from shading.types import Scalar

# The largest curvature of a form, that of r = 2 mm, and the largest width σ/r of a lobe
MOST_CURVATURE = 0.5
MOST_WIDTH = 1.5
_MOST = {"curvature": MOST_CURVATURE, "width": MOST_WIDTH}
_SYMBOLS = ("1", "c", "c²", "c⁴", "q", "p")
# The number of p among them, which alone may have no factor κ
_P = 5
MOST_BELOW = 4
# What the arguments of `hyperbola_form` may be, for a `Family`
ARGUMENTS = {
    "narrow": "fraction",
    "wide": "fraction",
    "numerator": "exponents",
    "below": range(MOST_BELOW + 1),
}


def _terms(c, numerator: Exponents) -> dict:
    """Return the coefficients of each function of the cosine, as sums of monomials of κ."""
    sums: dict[int, dict] = {}
    for k, (function, power) in enumerate(numerator):
        sums.setdefault(function, {})[(power,)] = c[k]
    return sums


@functools.cache
def hyperbola_form(
    reference: Reference, *, narrow: float, wide: float, numerator: Exponents, below: int
) -> Form:
    """Return the form D = (c + q)/2 + N/B of a channel, or of one Gaussian, on a surface.

    `narrow` and `wide` are the widths of q and Q at κ = 1/mm, in mm; of one Gaussian, those at
    s = σ/r = 1, and s stands for κ. `numerator` has pairs (i, j) for the terms fᵢ κʲ of N, where f
    is 1, c, c², c⁴, q, p. B = 1 + Σ of `below` powers of κ. Raises ValueError for another function,
    or for a term that does not vanish at κ = 0.
    """
    for i, j in numerator:
        if i > _P or (j == 0 and i != _P):
            raise ValueError(f"term {(i, j)}: allowed are functions 0 to 5, and κ⁰ with 5 only")
    if not narrow < wide:
        raise ValueError(f"narrow = {narrow:g}, wide = {wide:g}: allowed is narrow < wide")
    size = len(numerator)
    across = reference.axes[1]
    symbol = across.symbol

    def value(c, cosine: Scalar, curvature: Scalar) -> Array:
        x, k = jnp.asarray(cosine), jnp.asarray(curvature)
        x2 = x * x
        near, far = narrow * k, wide * k
        q = jnp.sqrt(x2 + near * near)
        p = jnp.sqrt(x2 + far * far) - q
        sums = {i: nested_horner(each, (k,)) for i, each in _terms(c, numerator).items()}
        even = sums.get(3)
        even = sums.get(2) if even is None else sums.get(2, 0) + x2 * even
        total = sums.get(0, 0)
        if even is not None:
            total = total + x2 * even
        for factor, i in ((x, 1), (q, 4), (p, 5)):
            if i in sums:
                total = total + factor * sums[i]
        if below:
            under: dict[tuple[int, ...], Any] = {
                (0,): ONE,
                **{(j + 1,): c[size + j] for j in range(below)},
            }
            total = total / nested_horner(under, (k,))
        return 0.5 * (x + q) + total

    names = [coefficient_name("a", (i, j)) for i, j in numerator]
    bottom = [f"b{j + 1}" for j in range(below)]
    shown = {(i, j): name for (i, j), name in zip(numerator, names, strict=True)}
    above = " + ".join(
        sum_text({(j,): _product(name, i)}, (symbol,)) for (i, j), name in shown.items()
    )
    shown_below = sum_text({(0,): 1.0, **{(j + 1,): b for j, b in enumerate(bottom)}}, (symbol,))
    return Form(
        name="lobe-skin" if across.name == "width" else "hyperbola-skin",
        equation=equation_of(
            "D",
            "(c + q)/2 + N/B" if below else "(c + q)/2 + N",
            [
                f"q = √(c² + ({narrow!r}·{symbol})²)",
                f"p = √(c² + ({wide!r}·{symbol})²) − q",
                f"N = {above}",
                *([f"B = {shown_below}"] if below else []),
            ],
        ),
        reference=reference,
        axes=restricted(reference.axes, **{across.name: (0.0, _MOST[across.name])}),
        coefficient_names=[*names, *bottom],
        stages=(Stage(value),),
        shape={
            "narrow": narrow,
            "wide": wide,
            "numerator": [list(each) for each in numerator],
            "below": below,
        },
    )


def _product(name: str, function: int) -> str:
    return name if function == 0 else f"{name}·{_SYMBOLS[function]}"


def _powers(*counts: int) -> Exponents:
    """Return pairs for so many powers of κ with each function: from κ on, with p from 1 on."""
    return tuple((i, j + (i != _P)) for i, count in enumerate(counts) for j in range(count))


# (narrow, wide, terms, below) of a channel, and of a lobe: 20 coefficients each
CHOSEN = {
    "red": (0.35, 0.9, _powers(4, 3, 3, 2, 3, 3), 2),
    "green": (0.15, 0.5, _powers(3, 3, 3, 2, 3, 4), 2),
    "blue": (0.1, 0.17, _powers(3, 3, 3, 2, 3, 4), 2),
}
CHOSEN_OF_LOBE = (0.9, 1.5, _powers(4, 3, 3, 2, 3, 3), 2)
# What the wider width of a lobe may be; the narrower one is less than 1.
WIDE = (1.0, 1.5, 2.0)


def _chosen(reference: Reference) -> tuple[float, float, Exponents, int]:
    return CHOSEN.get(reference.name.rpartition("-")[2], CHOSEN_OF_LOBE)


def candidates(reference: Reference) -> Iterator[Form]:
    """Yield the forms of a channel or of a lobe that a search tries."""
    narrow, wide, numerator, below = _chosen(reference)
    yield hyperbola_form(reference, narrow=narrow, wide=wide, numerator=numerator, below=below)


def without_denominator(reference: Reference) -> Form:
    """Return the form with B = 1, whose least squares fit is a linear problem."""
    narrow, wide, numerator, _ = _chosen(reference)
    return hyperbola_form(reference, narrow=narrow, wide=wide, numerator=numerator, below=0)
