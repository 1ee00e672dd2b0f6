"""Forms of E_avg, the average albedo of GGX.

As α → 0, 1 − E_avg = α² (ln(1/α) + c₀) + O(α⁴ ln α). With the logarithm and c₀ built in, the
relative error of 1 − E_avg, which energy compensation divides by, tends to 0 as α → 0.
"""

import functools
from collections.abc import Iterator
from typing import Any

import jax.numpy as jnp
import numpy as np
from jax import Array

from fitting.form import Form, Stage
from fitting.points.grids import gauss_grid
from fitting.shapes.monomial_sums import ONE, nested_horner
from fitting.solvers.on_grid import OnGrid
from integrals.microfacet.references import GGX_AVERAGE_ALBEDO
from integrals.reference import restricted
from quantities.microfacet.albedo_forms import LEAST_ALPHA
from quantities.microfacet.equations import average_equation
from shading.types import Scalar

AXES = restricted(GGX_AVERAGE_ALBEDO.axes, alpha=(LEAST_ALPHA, 1.0))
# The constant term of 1 − E_avg at small α (docs/microfacet.md).
C0 = float(3 / 5 + 19 / 15 * np.log(2) - 9 / 10 * np.log(3))
STRUCTURES = ("log", "free")
MOST_TERMS = 5


def _cubic(c, alpha: Scalar) -> Array:
    a = jnp.asarray(alpha)
    return 1 + a * (c[0] + a * (c[1] + a * c[2]))


# There are no constants in print for E_avg: the default form is the plainest one.
CUBIC = Form(
    name="cubic-ggx-average-albedo",
    equation="E_avg = 1 + c0·α + c1·α² + c2·α³",
    reference=GGX_AVERAGE_ALBEDO,
    axes=AXES,
    coefficient_names=["c0: α", "c1: α²", "c2: α³"],
    stages=(Stage(_cubic),),
    solver=OnGrid(gauss_grid),
)


@functools.cache
def average_form(*, structure: str, above: int, below: int) -> Form:
    """Return the form 1 − α² r, with r = ln(1/α) + c₀ + α N/D ('log') or r = N/D ('free').

    N has `above` coefficients, and D = 1 + Σ of `below` terms, from the power 1 on.
    """

    def value(c, alpha: Scalar) -> Array:
        a = jnp.asarray(alpha)
        r = nested_horner({(k,): c[k] for k in range(above)}, (a,))
        if below:
            terms: dict[tuple[int, ...], Any] = {
                (0,): ONE,
                **{(k + 1,): c[above + k] for k in range(below)},
            }
            r = r / nested_horner(terms, (a,))
        if structure == "log":
            r = C0 - jnp.log(a) + a * r
        return 1 - a * a * r

    return Form(
        name="quotient-ggx-average-albedo",
        equation=average_equation(above, below, C0 if structure == "log" else None),
        reference=GGX_AVERAGE_ALBEDO,
        axes=AXES,
        coefficient_names=[
            *(f"N: α^{k}" for k in range(above)),
            *(f"D: α^{k + 1}" for k in range(below)),
        ],
        stages=(Stage(value),),
        shape={"structure": structure, "above": above, "below": below},
    )


def candidates() -> Iterator[Form]:
    """Yield the forms of E_avg that a search tries."""
    for structure in STRUCTURES:
        for above in range(1, MOST_TERMS):
            for below in range(min(above + 2, MOST_TERMS)):
                yield average_form(structure=structure, above=above, below=below)
