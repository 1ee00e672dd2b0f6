"""Exact values: each integral with its closed form, quadrature and Monte Carlo, where they exist.

The legs of an integral share the model's functions and nothing else, so that each can judge the
others. All need float64, take scalars, and may be put under `jit`, `vmap` and `grad`.
"""

from integrals.fuzz.g import G as G
from integrals.fuzz.ps import PS as PS
from integrals.fuzz.q import Q as Q
from integrals.fuzz.r import R as R
from integrals.fuzz.velvet import VELVET as VELVET
from integrals.reference import Axis as Axis
from integrals.reference import Estimate as Estimate
from integrals.reference import Reference as Reference
from integrals.sampling import Sampling as Sampling

REFERENCES = {each.name: each for each in (PS, G, Q, R, VELVET)}
