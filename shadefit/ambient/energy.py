"""The energy of the fuzz BRDF, its ambient model and its deferred version in uniform light."""

import jax
import numpy as np

from integrals.rules.hemisphere import hemisphere_rule
from integrals.rules.interval import gauss_legendre
from shadefit.ambient.errors import COSINES, RULE, Radiances, place_of
from shading import deferred_radiance, direction
from shading.fuzz.deferred import WRAP


def energy(found: Radiances) -> list[dict]:
    """Give the largest radiance towards any view in uniform light of radiance one: no more is due.

    Of layer and base, exact and by the model with each set of functions; and of the deferred
    version by albedo, whose fibres have five times it.
    """
    column = found.lights.index("uniform")
    rows = []
    for name, parts in (("the BRDF itself", found.exact), *found.models.items()):
        total = parts["layer"][:, column] + parts["base"][:, column]
        worst = int(np.argmax(total))
        label = name if parts is found.exact else f"ambient model, {name} functions"
        where = place_of(found.points[worst])
        rows.append({"what": label, "largest": float(total[worst]), "where": where})
    for albedo in (0.1, 0.2, 0.4, 0.6):
        cosines = np.array(COSINES)
        seen = np.array([deferred_in_uniform_light(albedo, float(c)) for c in cosines])
        worst = int(np.argmax(seen))
        where = {"cos_v": float(cosines[worst])}
        rows.append(
            {"what": f"deferred, albedo {albedo:g}", "largest": float(seen[worst]), "where": where}
        )
    return rows


def deferred_in_uniform_light(albedo: float, cos_v: float) -> float:
    """Give the radiance of the deferred version at fuzziness one in uniform light of radiance one.

    Wrapped light comes from below the horizon as well.
    """
    above, weights = hemisphere_rule(**RULE)
    below, below_weights = gauss_legendre(16, -WRAP, 0.0)
    phi, sine = np.arange(64) * 2 * np.pi / 64, np.sqrt(1 - below**2)
    under = np.stack(
        [
            np.outer(sine, np.cos(phi)).ravel(),
            np.outer(sine, np.sin(phi)).ravel(),
            np.repeat(below, 64),
        ],
        axis=1,
    )
    every = np.concatenate([above, under])
    weights = np.concatenate([weights, np.repeat(below_weights, 64) * 2 * np.pi / 64])
    view = direction(np.arccos(cos_v), 0.0)
    seen = jax.jit(jax.vmap(lambda u: deferred_radiance(u, view, albedo, 1.0)))(every)
    return float(weights @ seen)
