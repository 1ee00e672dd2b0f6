"""The known quantities, by name. `register` adds a user's quantity while the program runs.

An installed package offers its quantities by entry points of the group `shadefit.problems`: the
name of the entry point is that of the quantity. The package is imported when the name is asked for.
"""

from importlib.metadata import entry_points

from quantities.curvature import CURVATURES
from quantities.detail import OPERATORS
from quantities.fuzz import PS, VELVET, G, Q, R
from quantities.maps import DECODERS, SGGX_FILTER, SGGX_FILTER_AXES
from quantities.microfacet import (
    GGX_AVERAGE_ALBEDO,
    GGX_BIAS,
    GGX_DIRECTIONAL_ALBEDO,
    GGX_SCALE,
    SAMPLERS,
)
from quantities.problem import Problem
from quantities.skin import BAND_QUANTITIES, LOBE_QUANTITIES, SKIN_QUANTITIES

GROUP = "shadefit.problems"

_FUZZ = (PS, G, Q, R, VELVET)
_MICROFACETS = (GGX_DIRECTIONAL_ALBEDO, GGX_SCALE, GGX_BIAS, GGX_AVERAGE_ALBEDO)
_MAPS = (SGGX_FILTER, SGGX_FILTER_AXES)
_SKIN = (*SKIN_QUANTITIES, *LOBE_QUANTITIES, *BAND_QUANTITIES)
_PROBLEMS: dict[str, Problem] = {
    each.name: each for each in (*_FUZZ, *_MICROFACETS, *_MAPS, *_SKIN)
}
# What is exported, but not fitted, by the first part of its name: samplers and their densities,
# decoders of textures, operators of detail maps, and curvature from light.
_FUNCTIONS = {
    "sampler": SAMPLERS,
    "decode": DECODERS,
    "detail": OPERATORS,
    "curvature": CURVATURES,
}


def problems() -> dict[str, Problem]:
    """Return all quantities by name, in the order in which they are listed."""
    return dict(_PROBLEMS)


def functions() -> dict[str, Problem]:
    """Return what is exported but not fitted, by its whole name, such as 'sampler/ggx-upper'."""
    return {
        f"{kind}/{name}": each for kind, own in _FUNCTIONS.items() for name, each in own.items()
    }


def problem(name: str) -> Problem:
    """Return the quantity with a name; load it if an installed package offers it.

    Raises ValueError if there is none.
    """
    if name not in _PROBLEMS and name in installed():
        (point,) = list(entry_points(group=GROUP, name=name))[:1]
        found = point.load()
        if not isinstance(found, Problem) or found.name != name:
            raise ValueError(f"{point.value} is no shadefit.Problem called {name!r}")
        register(found)
    if name not in _PROBLEMS:
        allowed = ", ".join(dict.fromkeys([*_PROBLEMS, *installed()]))
        raise ValueError(f"no quantity is called {name!r}: allowed are {allowed}")
    return _PROBLEMS[name]


def installed() -> list[str]:
    """Return the names of the quantities that installed packages offer; nothing is imported."""
    return sorted(entry_points(group=GROUP).names)


def register(new: Problem) -> Problem:
    """Add a quantity and return it. Raises ValueError if another quantity has its name."""
    if new.name in _PROBLEMS and _PROBLEMS[new.name] is not new:
        raise ValueError(f"a quantity is called {new.name!r} already: allowed is another name")
    _PROBLEMS[new.name] = new
    return new


def unregister(name: str) -> None:
    """Remove the quantity with a name, if there is one."""
    _PROBLEMS.pop(name, None)
