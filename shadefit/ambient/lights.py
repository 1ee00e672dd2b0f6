"""Lights that nine spherical harmonics represent exactly."""

import numpy as np

from shading import harmonics

# The harmonics of ((1 + ω·s)/2)² = 1/3 + (ω·s)/2 + P₂(ω·s)/6 are these times those of its axis s,
# by the addition theorem of spherical harmonics.
LOBE = (
    np.repeat([1 / 3, 1 / 2, 1 / 6], [1, 3, 5]) * 4 * np.pi / np.repeat([1.0, 3.0, 5.0], [1, 3, 5])
)


def lights() -> dict[str, np.ndarray]:
    """Return lights by name, as nine harmonics (9,) each.

    One is uniform with radiance 1. The others are broad lobes ((1 + ω·s)/2)² about a direction s,
    which need no harmonics beyond order 2 and are never negative. The fibre leans to azimuth 0.
    """
    about = {
        "from above": (0.0, 0.0, 1.0),
        "where fibres point": (1.0, 0.0, 0.0),
        "from the side": (0.0, 1.0, 0.0),
        "against fibres": (-1.0, 0.0, 0.0),
    }
    uniform = np.zeros(9)
    uniform[0] = np.sqrt(4 * np.pi)
    return {"uniform": uniform, **{name: lobe(np.array(s)) for name, s in about.items()}}


def lobe(axis: np.ndarray) -> np.ndarray:
    """Return the harmonics (9,) of the lobe ((1 + ω·s)/2)² about the unit vector s (3,)."""
    return LOBE * np.asarray(harmonics(axis))
