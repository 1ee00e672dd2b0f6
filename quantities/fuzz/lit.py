"""The quantity E_lit: the part of uniform light that one scattering event sends to a view.

It is not in the list of built-in quantities, because each ambient model has constants of its own
for it.
"""

import jax
import numpy as np

from integrals.fuzz.lit import E_LIT
from quantities.calling_convention import Argument, CallingConvention
from quantities.fuzz.lit_forms import AREA_RATIO, seen
from quantities.problem import Problem


def _columns(points: np.ndarray) -> np.ndarray:
    """Return v·t and P_s(v) (n, 2) at points (n, 4)."""
    return np.stack([np.asarray(each) for each in _seen(*points.T)], axis=1)


_seen = jax.jit(jax.vmap(seen))

LIT = Problem(
    reference=E_LIT,
    forms=(AREA_RATIO,),
    calling=CallingConvention(
        name="FuzzLit",
        summary="E_lit for one view.",
        arguments=(Argument("alpha", "alpha", clamp="both", local="alpha"),),
        remark="alpha, the roughness, is the projected area along the fibre t; TdotV = v·t of the "
        "view v, and scattered = P_s(v), exact or by a table",
        second=(("TdotV", (-1.0, 1.0)), ("scattered", (0.0, 1.0))),
        columns=_columns,
        codomain=E_LIT.codomain,
        material="FuzzLitMaterial",
    ),
    # With a topic, tables have no `about`. It would name an argument for each axis, but here v·t
    # and P_s stand for three axes.
    topic="fuzz",
)
