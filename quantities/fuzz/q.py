"""The quantity Q: the average chance of light to penetrate the layer."""

import jax.numpy as jnp
import numpy as np

import integrals
from fitting.form import FittedForm
from fitting.proofs.largest_error import ErrorCode, difference_code
from fitting.proofs.rounding_error import TracedArguments
from integrals.fuzz.q import average_penetration
from integrals.special.exponential import ein
from programs.functions import Function, Parameter, function
from quantities.calling_convention import Argument, CallingConvention, clamped
from quantities.family import Family
from quantities.fuzz.q_forms import AXES, LEAST_DENSITY, STRUCTURES, candidates, pole_q
from quantities.fuzz.supplement import QUADRATIC_Q
from quantities.plot_hints import AxisHint, PlotHints
from quantities.problem import ExactCode, Problem

# From this density on, exp(−d) is below the rounding of float64.
_OPAQUE = 64.0


def _error_code(fitted: FittedForm) -> ErrorCode:
    """Return the code of Q̃ − Q, with Q = 2E₃(d) by its series, for d ≤ 2.

    Three things are left out: the terms after the last one of the series, below 1e-20; the rounding
    of γ and of the series' coefficients, below 1e-15 together; and d² ln d for d below
    `LEAST_DENSITY`.
    """

    def exact(density):
        logarithm = jnp.log(jnp.maximum(density, LEAST_DENSITY))
        e1, escape = ein(density) - np.euler_gamma - logarithm, jnp.exp(-density)
        return escape - density * (escape - density * e1)

    return difference_code(fitted, exact, 1e-15)


def exact_functions(_: str) -> tuple[Function, ...]:
    """Return the closed form as a function of the density."""

    def value(density):
        return clamped(average_penetration(clamped(density, 0.0, _OPAQUE)), 0.0, 1.0)

    parameters = (Parameter("density", (AXES[0].lower, AXES[0].upper)),)
    summary = "Q in closed form, without coefficients."
    return (function("FuzzAveragePenetrationExact", parameters, value, summary),)


Q = Problem(
    reference=integrals.Q,
    forms=(QUADRATIC_Q,),
    families={
        "pole-q": Family(
            pole_q, {"structure": tuple(STRUCTURES), "terms": range(9), "poles": range(5)}
        ),
    },
    candidates=lambda _: candidates(),
    calling=CallingConvention(
        name="FuzzAveragePenetration",
        summary="Q ({equation}); clamps to the domain.",
        arguments=(Argument("density", "density", clamp="both", local="density"),),
        remark="density is thickness over mean free path",
    ),
    closed_form=average_penetration,
    error_code=_error_code,
    exact_code=ExactCode(
        "closed form: Q = 2·E3(density), where E3(x) is the exponential integral "
        "∫ exp(−x·t)/t³ dt over t ≥ 1",
        AXES,
        exact_functions,
        lambda points: (points,),
        "density is thickness over mean free path",
        traced=TracedArguments(AXES, lambda d: (d,), (False,)),
    ),
    plot=PlotHints(
        {"density": AxisHint("density $d$", 0.0, 0.5, 0.2, explored=(0.001, 1.0))},
        values=(0.0, 1.0),
        value_label="$Q$, mean penetration",
        exact_label="exact, $2E_3(d)$",
        largest_error=0.01,
    ),
    topic="fuzz",
)
