"""Encoding of anisotropic roughness into three channels, on arrays in float64.

`encodings` has the formulas back, and says what the encodings are.
"""

from collections.abc import Callable

import numpy as np
from jaxtyping import Float

from shading.maps.encodings import CENTRE, ENCODINGS, LEAST_LOGARITHMIC, SPREAD

Texels = Float[np.ndarray, "*texels 3"]
Numbers = Float[np.ndarray, "*texels"]


def entries_of_widths(
    alpha_t: Numbers | float, alpha_b: Numbers | float, theta: Numbers | float
) -> Texels:
    """Return (Sxx, Sxy, Syy) from the widths along a tangent at the angle θ (rad), and across it.

    Either width may be the larger one. A number stands for all texels.
    """
    alpha_t, alpha_b, theta = np.broadcast_arrays(alpha_t, alpha_b, theta)
    cos, sin = np.cos(theta), np.sin(theta)
    along, across = np.square(alpha_t), np.square(alpha_b)
    return np.stack(
        [
            along * cos * cos + across * sin * sin,
            (along - across) * cos * sin,
            along * sin * sin + across * cos * cos,
        ],
        axis=-1,
    )


def widths_of_entries(entries: Texels) -> tuple[Numbers, Numbers, Numbers]:
    """Return αt ≥ αb, and the angle θ of αt's tangent in [-π/2, π/2], from (Sxx, Sxy, Syy)."""
    sxx, sxy, syy = np.moveaxis(np.asarray(entries, float), -1, 0)
    half = np.hypot((sxx - syy) / 2, sxy)
    alpha_t = np.sqrt((sxx + syy) / 2 + half)
    alpha_b = np.sqrt(np.maximum(sxx * syy - sxy * sxy, 0.0)) / alpha_t
    theta = np.arctan2(2 * sxy, sxx - syy) / 2
    return np.asarray(alpha_t), np.asarray(alpha_b), np.asarray(theta)


def encode(encoding: str, alpha_t: Numbers, alpha_b: Numbers, theta: Numbers) -> Texels:
    """Return the channels (…, 3) in [0, 1] of widths along a tangent at the angle θ, and across.

    Raises ValueError for an unknown encoding, for a width that is not in (0, 1], and for an angle
    that is not finite.
    """
    if encoding not in _ENCODERS:
        raise ValueError(f"no encoding is called {encoding!r}: allowed are {', '.join(ENCODINGS)}")
    given = np.broadcast_arrays(*(np.asarray(each, float) for each in (alpha_t, alpha_b, theta)))
    for name, widths in zip(("αt", "αb"), given, strict=False):
        wrong = ~((widths > 0) & (widths <= 1))
        if wrong.any():
            raise ValueError(f"{name} = {widths[wrong].flat[0]:g}: allowed are numbers in (0, 1]")
    if not np.isfinite(given[2]).all():
        raise ValueError("an angle of the tangent is not finite: allowed are angles in radians")
    # NumPy makes numbers of arrays without axes.
    channels = _ENCODERS[encoding](*(np.atleast_1d(each) for each in given))
    return np.clip(channels, 0.0, 1.0).reshape(*given[0].shape, 3)


def _roots(alpha_t: Numbers, alpha_b: Numbers, theta: Numbers) -> tuple[Numbers, ...]:
    """Return √Sxx, √Syy, ρ and √(1 − ρ²)."""
    sxx, sxy, syy = np.moveaxis(entries_of_widths(alpha_t, alpha_b, theta), -1, 0)
    x, z = np.sqrt(sxx), np.sqrt(syy)
    return x, z, sxy / (x * z), alpha_t * alpha_b / (x * z)


def _published(*given: Numbers) -> Texels:
    x, z, rho, _ = _roots(*given)
    return np.stack([x, 0.5 + 0.5 * rho, z], axis=-1)


def _stereographic(*given: Numbers) -> Texels:
    x, z, rho, across = _roots(*given)
    return np.stack([x, 0.5 + 0.5 * rho / (1 + across), z], axis=-1)


def _components(first: Numbers, second: Numbers, theta: Numbers) -> Texels:
    mean, half = (first + second) / 2, (first - second) / 2
    along, across = half * np.cos(2 * theta), half * np.sin(2 * theta)
    return np.stack([mean, CENTRE + SPREAD * along, CENTRE + SPREAD * across], axis=-1)


def _quarter_root(alpha_t: Numbers, alpha_b: Numbers, theta: Numbers) -> Texels:
    return _components(np.sqrt(alpha_t), np.sqrt(alpha_b), theta)


def _logarithmic(alpha_t: Numbers, alpha_b: Numbers, theta: Numbers) -> Texels:
    first, second = (
        1 - np.log(np.maximum(each, LEAST_LOGARITHMIC)) / np.log(LEAST_LOGARITHMIC)
        for each in (alpha_t, alpha_b)
    )
    return _components(first, second, theta)


_ENCODERS: dict[str, Callable[..., Texels]] = {
    "published": _published,
    "stereographic": _stereographic,
    "quarter-root": _quarter_root,
    "logarithmic": _logarithmic,
}
