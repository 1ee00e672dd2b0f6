"""The quantities of the fuzz BRDF of Ghost of Tsushima: P_s, G, Q, R, and velvet's r(k).

Each is imported when it is first used: velvet's takes SciPy's linear programs, for example.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from quantities.fuzz.g import G as G
    from quantities.fuzz.ps import PS as PS
    from quantities.fuzz.q import Q as Q
    from quantities.fuzz.r import R as R
    from quantities.fuzz.velvet import VELVET as VELVET

_MODULES = {
    "G": "quantities.fuzz.g",
    "PS": "quantities.fuzz.ps",
    "Q": "quantities.fuzz.q",
    "R": "quantities.fuzz.r",
    "VELVET": "quantities.fuzz.velvet",
}


def __getattr__(name: str) -> Any:
    """Import a public name when it is first used."""
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_MODULES[name]), name)
