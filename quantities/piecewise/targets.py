"""The NDFs that a piecewise-linear one is fitted to: analytic ones, and measured samples.

A target is named as on the command line: `ggx:0.1`, `beckmann:0.1`, `student-t:0.1,3` (the width,
and the exponent γ of the Student-t NDF), or it is a table of angles and values. `ggx:0.1,0.3` and
`beckmann:0.1,0.3` are anisotropic, with the widths along x and y.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import jax
import numpy as np
from scipy.interpolate import PchipInterpolator

from integrals.data import table
from integrals.piecewise.smith import hidden_rule
from integrals.rules.interval import composite_gauss
from shading.piecewise import slopes

# Steps between the angles at which a target is integrated: small enough for widths above 0.002.
_FINEST, _PANELS = 5e-4, 60


@dataclass(frozen=True, eq=False)
class Target:
    """An isotropic NDF to fit: `of` maps angles (k,) in radians to values (k,), per steradian.

    `mass` is what the values were divided by to make ∫ D cos θ dω = 1.
    """

    name: str
    of: Callable[[np.ndarray], np.ndarray]
    mass: float

    def hidden_areas(self, angles: np.ndarray) -> np.ndarray:
        """Return H (k,) of directions at the polar angles `angles` (k,), by quadrature."""
        return hidden_areas_of(self.of, angles)


@dataclass(frozen=True, eq=False)
class AnisotropicTarget:
    """An anisotropic NDF to fit: of GGX or Beckmann, with the widths αx and αy along x and y.

    Both are distributions of slopes that are stretched along x and y. At the azimuth φ, D is the
    isotropic one of the width (cos²φ/αx² + sin²φ/αy²)^(−½) times that width squared over αx αy, and
    Λ is the isotropic one of the width √(αx² cos²φ + αy² sin²φ).
    """

    name: str
    kind: str
    widths: tuple[float, float]

    def profile(self, width: float) -> Target:
        """Return the isotropic NDF of this kind and of a width."""
        return _analytic(self.kind, (width,))

    def of(self, theta: np.ndarray, phi: np.ndarray | float) -> np.ndarray:
        """Return D, per steradian, at polar angles and azimuths in radians, which broadcast."""
        x, y = self.widths
        width = 1 / np.hypot(np.cos(phi) / x, np.sin(phi) / y)
        own = slopes.beckmann if self.kind == "beckmann" else partial(slopes.student_t, exponent=2)
        return np.asarray(own(theta, width)) * width**2 / (x * y)

    def hidden_areas(self, theta: np.ndarray, phi: np.ndarray) -> np.ndarray:
        """Return H (k,) of directions at polar angles (k,) and azimuths (k,), in radians."""
        x, y = self.widths
        found = np.zeros(len(theta))
        for each in np.unique(phi):
            at = phi == each
            width = float(np.hypot(x * np.cos(each), y * np.sin(each)))
            found[at] = self.profile(width).hidden_areas(theta[at])
        return found


def breaks() -> np.ndarray:
    """Return increasing angles from 0 to π/2 between which targets are integrated."""
    return np.concatenate([[0.0], np.geomspace(_FINEST, np.pi / 2, _PANELS)])


def hidden_areas_of(of: Callable, angles: np.ndarray) -> np.ndarray:
    """Return H (k,) of an isotropic NDF at polar angles (k,)."""
    theta, weights = (np.asarray(each) for each in _rules(np.asarray(angles), breaks()))
    return np.sum(weights * np.reshape(of(theta.ravel()), theta.shape), axis=1)


@jax.jit
def _rules(angles: jax.Array, places: jax.Array) -> tuple[jax.Array, jax.Array]:
    return jax.vmap(lambda theta_o: hidden_rule(theta_o, places, nodes=12))(angles)


def analytic_ndf(name: str) -> Target:
    """Return the isotropic target of a name such as 'ggx:0.1'. Raises ValueError for others."""
    found = named_ndf(name)
    if isinstance(found, AnisotropicTarget):
        raise ValueError(f"{name!r} is anisotropic: allowed here is one width")
    return found


def named_ndf(name: str) -> Target | AnisotropicTarget:
    """Return the target of a name such as 'ggx:0.1', or 'ggx:0.1,0.3' with two widths.

    The first width is along x. Raises ValueError for other names, and for widths outside 0.005 to 2
    and exponents outside 1.6 to 1000.
    """
    kind, _, numbers = name.partition(":")
    try:
        given = tuple(float(part) for part in numbers.split(","))
    except ValueError:
        given = ()
    if len(given) not in {"ggx": (1, 2), "beckmann": (1, 2), "student-t": (2,)}.get(kind, ()):
        raise ValueError(
            f"{name!r} is no NDF: allowed are ggx:WIDTH, beckmann:WIDTH, ggx:WIDTH,WIDTH, "
            "beckmann:WIDTH,WIDTH, student-t:WIDTH,EXPONENT, or the name of a file of columns"
        )
    for width in given[:1] if kind == "student-t" else given:
        if not 0.005 <= width <= 2:
            raise ValueError(f"{name}: width {width:g}: allowed are 0.005 to 2")
    if kind == "student-t" and not 1.6 <= given[1] <= 1000:
        raise ValueError(f"{name}: exponent {given[1]:g}: allowed are 1.6 to 1000")
    if kind != "student-t" and len(given) == 2:
        return AnisotropicTarget(name, kind, (given[0], given[1]))
    return _analytic(kind, given, name)


def _analytic(kind: str, given: tuple[float, ...], name: str = "") -> Target:
    if kind == "beckmann":
        of = partial(_numpy, slopes.beckmann, given[:1])
    else:
        of = partial(_numpy, slopes.student_t, (given[0], 2.0 if kind == "ggx" else given[1]))
    return Target(name, of, 1.0)


def _numpy(function: Callable, parameters: tuple[float, ...], theta: np.ndarray) -> np.ndarray:
    return np.asarray(function(theta, *parameters))


def measured_ndf(
    path: Path, angle: str = "theta", value: str = "D", *, degrees: bool = False
) -> Target:
    """Return the target of a file with a column of angles and one of values of D.

    The values may be in any unit: they are divided by their mass. In between they are interpolated
    by monotone cubics, and D is constant before the first and after the last angle. Raises
    ValueError for fewer than four rows, angles outside [0, π/2] or given twice, and values that are
    negative or not finite.
    """
    rows = table(path, [angle], value, None)
    theta, d = np.asarray(rows.points)[:, 0], np.asarray(rows.values, float)
    theta = np.radians(theta) if degrees else theta
    order = np.argsort(theta)
    theta, d = theta[order], d[order]
    if len(theta) < 4:
        raise ValueError(f"{path}: {len(theta)} rows: at least 4 are needed")
    if theta[0] < 0 or theta[-1] > np.pi / 2 + 1e-9:
        raise ValueError(
            f"{path}: column {angle!r} is from {theta[0]:g} to {theta[-1]:g} radians: allowed are "
            "those from 0 to π/2 (90 with --degrees)"
        )
    if (np.diff(theta) <= 0).any():
        raise ValueError(f"{path}: column {angle!r} has an angle twice: allowed is once")
    if (d < 0).any() or not d.any():
        raise ValueError(f"{path}: column {value!r}: allowed are numbers ≥ 0 that are not all zero")
    between = PchipInterpolator(theta, d)

    def raw(at):
        return np.maximum(between(np.clip(at, theta[0], theta[-1])), 0.0)

    ends = np.unique(np.concatenate([[0.0, np.pi / 2], np.minimum(theta, np.pi / 2)]))
    at, weight = composite_gauss(ends, 6)
    mass = float(2 * np.pi * np.sum(weight * raw(at) * np.cos(at) * np.sin(at)))
    return Target(path.name, lambda at: raw(at) / mass, mass)
