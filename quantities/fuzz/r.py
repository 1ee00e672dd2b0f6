"""R: average of P_s over lights."""

import numpy as np

import integrals
from quantities.calling_convention import Argument, CallingConvention
from quantities.family import Family
from quantities.fuzz.r_forms import VARIABLES, candidates, monomial_r
from quantities.fuzz.supplement import RATIONAL_R
from quantities.problem import AxisHint, PlotHints, Problem

R = Problem(
    reference=integrals.R,
    default=RATIONAL_R,
    families={
        "monomial-r": Family(
            monomial_r,
            {
                "variable": tuple(VARIABLES),
                "numerator": "exponents",
                "denominator": "exponents or none",
                "least_alpha": "fraction",
            },
        ),
    },
    candidates=lambda lower: candidates(lower["alpha"]),
    calling=CallingConvention(
        name="FuzzAveragePs",
        summary="R ({equation}); clamps to the domain.",
        arguments=(
            Argument("alpha", "alpha", clamp="both", local="alpha"),
            Argument("theta_f", "thetaF", clamp="both", local="theta_f"),
        ),
        remark="alpha, the roughness, is the projected area along the fibre, thetaF its polar "
        "angle",
    ),
    plot=PlotHints(
        {
            "alpha": AxisHint("α", 0.05, 1.0, 0.35),
            "theta_f": AxisHint(
                "fibre's angle $θ_f$ / °", 0.0, np.pi / 2, np.pi / 4, factor=180 / np.pi
            ),
        },
        largest_error=1e-3,
    ),
    topic="fuzz",
    searches_best=True,
)
