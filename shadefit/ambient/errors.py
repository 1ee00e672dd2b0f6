"""Errors of the ambient model: one row for each part of the radiance and each light."""

from itertools import product

import jax
import numpy as np

from integrals import PS
from shadefit.ambient.radiances import Radiances, named_place, phase_integrals

PARTS = ("layer", "base")


def model_errors(found: Radiances) -> list[dict]:
    """Return a row of errors for each part and light, relative to the mean exact radiance.

    `rms` and `bias` have a number for each set of functions. `worst` is the largest error of the
    model with the first set, and `where` is the material and view that has it.
    """
    rows = []
    for part, (i, light) in product(PARTS, enumerate(found.lights)):
        exact = found.exact[part][:, i]
        mean = float(exact.mean())
        off = {name: model[part][:, i] - exact for name, model in found.models.items()}
        first = next(iter(off.values()))
        worst = int(np.argmax(np.abs(first)))
        rows.append(
            {
                "part": part,
                "light": light,
                "mean": mean,
                "rms": {k: float(np.sqrt(np.mean(v**2)) / mean) for k, v in off.items()},
                "bias": {k: float(v.mean() / mean) for k, v in off.items()},
                "worst": float(first[worst] / mean),
                "where": named_place(found.points[worst]),
            }
        )
    return rows


def errors_with_phase_integral(found: Radiances) -> dict[str, float]:
    """Return the layer's relative rms error by light if the model used ∫ p(u, v) dω_u.

    The model uses 1 − P_s(v) = ∫ p(v, u) dω_u in its place, as if p were symmetric. All functions
    are exact here. The error that remains is that of averaging the light before it is multiplied by
    the phase function.
    """
    alpha, theta_f, _, theta_v, phi = found.points.T
    down = jax.jit(jax.vmap(PS.value))(alpha, theta_f, theta_v, phi)
    factor = phase_integrals(found.points) / (1 - np.asarray(down))
    off = found.models["exact"]["layer"] * factor[:, None] - found.exact["layer"]
    relative = np.sqrt(np.mean(off**2, axis=0)) / found.exact["layer"].mean(axis=0)
    return {light: float(x) for light, x in zip(found.lights, relative, strict=True)}
