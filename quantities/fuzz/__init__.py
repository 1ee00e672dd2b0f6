"""The quantities of the fuzz BRDF of Ghost of Tsushima: P_s, G, Q, R, and velvet's r(k)."""

from quantities.fuzz.g import G as G
from quantities.fuzz.ps import PS as PS
from quantities.fuzz.q import Q as Q
from quantities.fuzz.r import R as R
from quantities.fuzz.velvet import VELVET as VELVET
