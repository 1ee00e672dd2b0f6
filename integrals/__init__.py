"""Exact values: each integral with its closed form, quadrature and Monte Carlo, where they exist.

The legs of an integral share the model's functions and nothing else, so that each can judge the
others. All need float64, take scalars, and may be put under `jit`, `vmap` and `grad`.
"""

from integrals.g import G as G
from integrals.integral import Axis as Axis
from integrals.integral import Estimate as Estimate
from integrals.integral import Integral as Integral
from integrals.ps import PS as PS
from integrals.q import Q as Q
from integrals.r import R as R
from integrals.velvet import VELVET as VELVET

INTEGRALS = {integral.name: integral for integral in (PS, G, Q, R, VELVET)}
