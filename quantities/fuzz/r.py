"""The quantity R: the average of P_s over lights."""

import numpy as np

import integrals
from integrals.rules.interval import gauss_legendre
from quantities.calling_convention import Argument, CallingConvention
from quantities.family import Family
from quantities.fuzz.ps import PS
from quantities.fuzz.r_error import error_code
from quantities.fuzz.r_forms import VARIABLES, candidates, monomial_r
from quantities.fuzz.supplement import RATIONAL_R
from quantities.plot_hints import AxisHint, PlotHints
from quantities.problem import Average, Problem

# The explorer averages P_s over lights by the rule of `integrals.fuzz.r.average_over_lights` with
# this many nodes an angle. tests/shadefit/test_explorer.py bounds its error.
_NODES = 48
_COSINES, _WEIGHTS = gauss_legendre(_NODES, 0.0, 1.0)
_POLAR_RULE = np.arccos(_COSINES), 2 * _WEIGHTS * _COSINES
_AZIMUTH_RULE = (np.arange(_NODES) + 0.5) * np.pi / _NODES, np.full(_NODES, 1 / _NODES)

R = Problem(
    reference=integrals.R,
    forms=(RATIONAL_R,),
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
    search_lower={"alpha": 0.15},
    error_code=error_code,
    calling=CallingConvention(
        name="FuzzAveragePs",
        summary="R ({equation}); clamps to the domain.",
        arguments=(
            Argument("alpha", "alpha", clamp="both", local="alpha"),
            Argument("theta_f", "thetaF", clamp="both", local="theta_f", cosine="NdotT"),
        ),
        remark="alpha, the roughness, is the projected area along the fibre, thetaF its polar "
        "angle",
    ),
    plot=PlotHints(
        {
            "alpha": AxisHint("α", 0.15, 1.0, 0.35, explored=(0.05, 1.0)),
            "theta_f": AxisHint(
                "fibre's angle $θ_f$",
                0.0,
                np.pi / 2,
                np.pi / 4,
                short_label="$θ_f$",
                factor=180 / np.pi,
                unit="°",
            ),
        },
        values=(0.0, 1.0),
        largest_error=1e-3,
        azimuth=-40.0,
    ),
    average=Average(PS, (_POLAR_RULE, _AZIMUTH_RULE)),
    topic="fuzz",
    searches_best=True,
)
