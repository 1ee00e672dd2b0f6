"""Lights that nine spherical harmonics represent exactly."""

import numpy as np

from shading import harmonics
from shading.harmonics import LOBE, UNIFORM


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
    lobes = {name: LOBE * np.asarray(harmonics(np.array(s))) for name, s in about.items()}
    return {"uniform": UNIFORM, **lobes}
