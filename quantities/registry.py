"""The known quantities, by name. `register` adds a user's quantity while the program runs.

A built-in quantity is imported when it is first asked for, so that a command does not wait for the
others. The name of the module comes from the tables below, never from a file.

An installed package offers its quantities by entry points of the group `shadefit.problems`: the
name of the entry point is that of the quantity. The package is imported when the name is asked for.
"""

from collections.abc import Sequence
from functools import cache
from importlib import import_module
from importlib.metadata import entry_points

from quantities.problem import Problem

GROUP = "shadefit.problems"

_ALBEDO = "quantities.microfacet.directional_albedo"
_SPLIT = "quantities.microfacet.fresnel_split"
_AVERAGE = "quantities.microfacet.average_albedo"
_FILTERED = "quantities.maps.filtered_width"
_SKIN = "quantities.skin.scattering"
_LOBES = ("quantities.skin.lobes", "LOBE_QUANTITIES")
_BANDS = ("quantities.skin.bands", "BAND_QUANTITIES")
# The built-in quantities by name, in the order in which they are listed: the module that declares
# each, and the name there of the quantity, or of several quantities.
_DECLARED_IN = {
    "ps": ("quantities.fuzz.ps", "PS"),
    "g": ("quantities.fuzz.g", "G"),
    "q": ("quantities.fuzz.q", "Q"),
    "r": ("quantities.fuzz.r", "R"),
    "velvet": ("quantities.fuzz.velvet", "VELVET"),
    "ggx-directional-albedo": (_ALBEDO, "GGX_DIRECTIONAL_ALBEDO"),
    "ggx-scale": (_SPLIT, "GGX_SCALE"),
    "ggx-bias": (_SPLIT, "GGX_BIAS"),
    "ggx-average-albedo": (_AVERAGE, "GGX_AVERAGE_ALBEDO"),
    "sggx-filter": (_FILTERED, "SGGX_FILTER"),
    "sggx-filter-axes": (_FILTERED, "SGGX_FILTER_AXES"),
    "skin-cylinder-red": (_SKIN, "SKIN_QUANTITIES"),
    "skin-cylinder-green": (_SKIN, "SKIN_QUANTITIES"),
    "skin-cylinder-blue": (_SKIN, "SKIN_QUANTITIES"),
    "skin-sphere-red": (_SKIN, "SKIN_QUANTITIES"),
    "skin-sphere-green": (_SKIN, "SKIN_QUANTITIES"),
    "skin-sphere-blue": (_SKIN, "SKIN_QUANTITIES"),
    "skin-lobe-cylinder": _LOBES,
    "skin-lobe-sphere": _LOBES,
    "skin-band-1-red": _BANDS,
    "skin-band-1-green": _BANDS,
    "skin-band-1-blue": _BANDS,
    "skin-band-2-red": _BANDS,
    "skin-band-2-green": _BANDS,
    "skin-band-2-blue": _BANDS,
}
# What is exported, but not fitted, by the first part of its name: samplers and their densities,
# decoders of textures, operators of detail maps, and curvature from light.
_FUNCTIONS = {
    "sampler": ("quantities.microfacet.samplers", "SAMPLERS"),
    "decode": ("quantities.maps.decoders", "DECODERS"),
    "detail": ("quantities.detail", "OPERATORS"),
    "curvature": ("quantities.curvature", "CURVATURES"),
}
BUILT_IN = tuple(_DECLARED_IN)
# Those that users and installed packages declared.
_REGISTERED: dict[str, Problem] = {}


def names() -> list[str]:
    """Return the names of all quantities in the order in which they are listed."""
    return [*BUILT_IN, *_REGISTERED]


def problems() -> dict[str, Problem]:
    """Return all quantities by name, in the order in which they are listed."""
    return {**{name: _built_in(name) for name in BUILT_IN}, **_REGISTERED}


def registered() -> dict[str, Problem]:
    """Return the quantities that users and installed packages declared, by name."""
    return dict(_REGISTERED)


def functions(kind: str | None = None) -> dict[str, Problem]:
    """Return what is exported but not fitted, by its whole name, such as 'sampler/ggx-upper'.

    `kind`, the first part of the names, leaves out the others.
    """
    kinds = [each for each in _FUNCTIONS if kind in (None, each)]
    return {f"{each}/{name}": own for each in kinds for name, own in _declared(each).items()}


def problem(name: str) -> Problem:
    """Return the quantity with a name; load it if an installed package offers it.

    Raises ValueError if there is none.
    """
    if name in _DECLARED_IN:
        return _built_in(name)
    if name not in _REGISTERED and name in installed():
        (point,) = list(entry_points(group=GROUP, name=name))[:1]
        found = point.load()
        if not isinstance(found, Problem) or found.name != name:
            raise ValueError(f"{point.value} is no shadefit.Problem called {name!r}")
        register(found)
    if name not in _REGISTERED:
        allowed = ", ".join(dict.fromkeys([*names(), *installed()]))
        raise ValueError(f"no quantity is called {name!r}: allowed are {allowed}")
    return _REGISTERED[name]


def installed() -> list[str]:
    """Return the names of the quantities that installed packages offer; nothing is imported."""
    return sorted(entry_points(group=GROUP).names)


def register(new: Problem) -> Problem:
    """Add a quantity and return it. Raises ValueError if another quantity has its name."""
    known = _built_in(new.name) if new.name in _DECLARED_IN else _REGISTERED.get(new.name, new)
    if known is not new:
        raise ValueError(f"a quantity is called {new.name!r} already: allowed is another name")
    if new.name not in _DECLARED_IN:
        _REGISTERED[new.name] = new
    return new


def unregister(name: str) -> None:
    """Remove the quantity with a name, if a user declared it."""
    _REGISTERED.pop(name, None)


@cache
def _built_in(name: str) -> Problem:
    module, constant = _DECLARED_IN[name]
    found = getattr(import_module(module), constant)
    every = found if isinstance(found, Sequence) else [found]
    return next(each for each in every if each.name == name)


def _declared(kind: str) -> dict[str, Problem]:
    module, constant = _FUNCTIONS[kind]
    return getattr(import_module(module), constant)
