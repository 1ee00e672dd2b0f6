"""What a segment and a knot contribute to the hidden area, as straight-line code of scalars.

The kernel K(u) of the hidden area is nowhere negative: H = ∫ D(u) K(u) du over u = cos θ from 0 to
sin θo. All areas below are sums of two of its integrals from u to sin θo: B = ∫ K, and
T = ∫ (u′² − u²) K du′, which is what a change of the slope of D at the cosine u adds to H.
"""

from dataclasses import dataclass
from functools import cached_property

import jax.numpy as jnp
import numpy as np
from jax import Array

from shading.piecewise.ndf import Profile

# The arctangent of 0 to 1 is t times a polynomial of t², Abramowitz and Stegun 4.4.49, to 2e-8
# relative. Those of shading languages may be wrong by thousands of units in the last place, and the
# differences of angles below would magnify that.
_ARCTANGENT = (
    *(1.0, -0.3333314528, 0.1999355085, -0.1420889944, 0.1065626393),
    *(-0.0752896400, 0.0429096138, -0.0161657367, 0.0028662257),
)
# Divisors are at least this. It only counts where what is divided is zero.
LEAST = 1e-30


@dataclass(frozen=True, eq=False)
class Places:
    """The constants of an NDF that is linear in cos²θ, in float64.

    At each knot (n,): `squares` sin²θ, `cosines` cos θ, `drops` 1 − cos θ, `values` D, and `below`
    the mass below it. `slopes` (n − 1,) are those of D over cos²θ, and `bends` (n − 2,) their
    changes at the inner knots.
    """

    squares: np.ndarray
    cosines: np.ndarray
    values: np.ndarray
    drops: np.ndarray

    @cached_property
    def slopes(self) -> np.ndarray:
        """The slope of D over cos²θ in each segment."""
        return -np.diff(self.values) / np.diff(self.squares)

    @cached_property
    def bends(self) -> np.ndarray:
        """How much the slope is larger before each inner knot than after it."""
        return -np.diff(self.slopes)

    @cached_property
    def below(self) -> np.ndarray:
        """The mass below each knot. D (sin²θ) has the mass of a trapezoid times π."""
        parts = np.diff(self.squares) * (self.values[1:] + self.values[:-1]) / 2
        return np.pi * np.concatenate([[0.0], np.cumsum(parts)])


def places_of(ndf: Profile) -> Places:
    """Return the constants of an NDF.

    Raises ValueError if it is linear in the angle: its hidden area has no closed form.
    """
    if ndf.variable != "cos2":
        raise ValueError("code is written for NDFs that are linear in 'cos2' only")
    knots = np.asarray(ndf.knots)
    cosines = np.cos(knots)
    cosines[-1] = 0.0
    drops = 2 * np.sin(knots / 2) ** 2
    drops[-1] = 1.0
    return Places(np.sin(knots) ** 2, cosines, np.asarray(ndf.values), drops)


@dataclass(frozen=True, eq=False)
class View:
    """The direction o: c = cos θo, h = 1 − c, sin θo, and `turn`, ±cos 2φo for a part of a blend.

    `turn` is None for an isotropic NDF.
    """

    cosine: Array
    drop: Array
    squared_sine: Array
    sine: Array
    turn: Array | None = None


def view_of(cosine: Array, turn: Array | None = None) -> View:
    """Return the direction of a cosine."""
    drop = 1 - cosine
    squared_sine = drop * (1 + cosine)
    return View(cosine, drop, squared_sine, jnp.sqrt(squared_sine), turn)


@dataclass(frozen=True, eq=False)
class Kernels:
    """At the cosine u: `level` B and `bent` T.

    `rim` is r = √(sin²θo − u²), zero where no normal faces away, and `azimuth` is C, half the arc
    of azimuths that do.
    """

    level: Array
    bent: Array
    rim: Array
    azimuth: Array


def kernels(u, view: View) -> Kernels:
    """Return the kernels at the cosine u, which may be a constant."""
    # notation: A, δ, u, r = rim, s and c as in shading.piecewise.hidden_area
    c, h, u2 = view.cosine, view.drop, u * u
    rim2 = jnp.maximum((view.sine - u) * (view.sine + u), 0.0)
    rim = jnp.sqrt(rim2)
    opened = angle(rim, u)
    chord = u * rim
    delta = angle(h * chord, c * u2 + rim2)
    flat = 1 - u2
    level = opened * (h + c * u2) - chord - c * flat * delta
    bent = (
        opened * (h * (h / 4 - u2) - c * (u2 * u2 / 2))
        + chord * ((1 + 2 * u2) / 4)
        - c * (flat * flat / 2) * delta
    )
    if view.turn is not None:
        more_level, more_bent = _lean(u2, rim2, opened, chord, delta, view)
        level, bent = level + view.turn * more_level, bent + view.turn * more_bent
    return Kernels(level, bent, rim, opened + delta)


def _lean(u2, rim2, opened, chord, delta, view: View) -> tuple[Array, Array]:
    """Return what cos 2φ adds to B and T: ∫ and ∫ (u′² − u²) of (2/3) r³/(s²(1 − u²)) du."""
    c, s2 = view.cosine, jnp.maximum(view.squared_sine, LEAST)
    part = chord / s2
    whole = (opened - part) / 2 + c * c * (c * delta / s2 - opened / (1 + c))
    fourth = 3 * opened / 8 - part * (3 + 2 * rim2 / s2) / 8
    return 2 / 3 * whole, 2 / 3 * ((1 - u2) * whole - view.squared_sine * fourth)


def ring(u, flat, found: Kernels, view: View) -> Array:
    """Return ∫ max(o·m, 0) (1 ± cos 2φ) dφ at the cosine u; `flat` is 1 − u²."""
    height = view.cosine * u
    area = 2 * (np.pi * height + found.rim - height * found.azimuth)
    if view.turn is None:
        return area
    across = jnp.maximum(view.squared_sine * flat, LEAST)
    return area + view.turn * (2 / 3) * found.rim * (found.rim * found.rim / across)


def hidden_code(places: Places, view: View) -> Array:
    """Return H: each inner knot adds T at its cosine times the change of the slope there."""
    # The last knot is at u = 0, where A = π/2 and δ = 0.
    last, slope = places.values[-1], places.slopes[-1]
    total = np.pi / 2 * view.drop * (last + slope / 4 * view.drop)
    if view.turn is not None:
        end = kernels(jnp.zeros_like(view.cosine), view)
        total = last * end.level + slope * end.bent
    for u, bend in zip(places.cosines[1:-1], places.bends, strict=True):
        total = total + bend * kernels(u, view).bent
    return jnp.maximum(total, 0.0)


def angle(y, x) -> Array:
    """Return atan2(y, x) for y, x ≥ 0; 0 at the origin."""
    t = jnp.minimum(x, y) / jnp.maximum(jnp.maximum(x, y), LEAST)
    squared = t * t
    total = jnp.asarray(_ARCTANGENT[-1])
    for coefficient in _ARCTANGENT[-2::-1]:
        total = coefficient + squared * total
    near = t * total
    return jnp.where(y > x, np.pi / 2 - near, near)
