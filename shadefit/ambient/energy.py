"""The largest radiances of the fuzz BRDF, its ambient model and deferred version in uniform light.

In uniform light of radiance 1, a surface that creates no energy has no radiance above 1.
"""

import jax
import numpy as np

from integrals.rules.hemisphere import hemisphere_rule
from integrals.rules.interval import gauss_legendre
from shadefit.ambient.radiances import COSINES, HEMISPHERE_RULE, Radiances, named_place
from shading import deferred_radiance, direction
from shading.fuzz.deferred import WRAP

# Albedos of the base; the deferred version's fibres have five times the albedo.
ALBEDOS = (0.1, 0.2, 0.4, 0.6)


def largest_radiances(found: Radiances) -> list[dict]:
    """Return a row with the largest radiance in uniform light and its place for each method.

    The methods are the BRDF itself and the ambient model with each set of functions (layer and base
    together), and the deferred version with each of `ALBEDOS`.
    """
    column = found.lights.index("uniform")
    rows = []
    for name, parts in (("the BRDF itself", found.exact), *found.models.items()):
        total = parts["layer"][:, column] + parts["base"][:, column]
        worst = int(np.argmax(total))
        label = name if parts is found.exact else f"ambient model, {name} functions"
        where = named_place(found.points[worst])
        rows.append({"what": label, "largest": float(total[worst]), "where": where})
    for albedo in ALBEDOS:
        cosines = np.array(COSINES)
        seen = np.array([deferred_in_uniform_light(albedo, float(c)) for c in cosines])
        worst = int(np.argmax(seen))
        where = {"cos_v": float(cosines[worst])}
        rows.append(
            {"what": f"deferred, albedo {albedo:g}", "largest": float(seen[worst]), "where": where}
        )
    return rows


def deferred_in_uniform_light(albedo: float, cos_v: float) -> float:
    """Return the radiance of the deferred version at fuzziness 1 in uniform light of radiance 1.

    Wrapped lighting also counts light from a little below the horizon, down to a cosine of −WRAP.
    """
    above, weights = hemisphere_rule(**HEMISPHERE_RULE)
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
