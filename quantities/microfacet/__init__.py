"""The quantities of GGX microfacets: E, A and B of its Fresnel split, E_avg, and the samplers.

Each is imported when it is first used.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from quantities.microfacet.average_albedo import GGX_AVERAGE_ALBEDO as GGX_AVERAGE_ALBEDO
    from quantities.microfacet.directional_albedo import (
        GGX_DIRECTIONAL_ALBEDO as GGX_DIRECTIONAL_ALBEDO,
    )
    from quantities.microfacet.fresnel_split import GGX_BIAS as GGX_BIAS
    from quantities.microfacet.fresnel_split import GGX_SCALE as GGX_SCALE
    from quantities.microfacet.samplers import SAMPLERS as SAMPLERS

_MODULES = {
    "GGX_AVERAGE_ALBEDO": "quantities.microfacet.average_albedo",
    "GGX_DIRECTIONAL_ALBEDO": "quantities.microfacet.directional_albedo",
    "GGX_BIAS": "quantities.microfacet.fresnel_split",
    "GGX_SCALE": "quantities.microfacet.fresnel_split",
    "SAMPLERS": "quantities.microfacet.samplers",
}


def __getattr__(name: str) -> Any:
    """Import a public name when it is first used."""
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_MODULES[name]), name)
