"""`shadefit ambient`: the ambient model against the integral that it stands for, and energy.

White fibres over a white base, so that every figure is a fraction of the light. The exact radiance
is a quadrature of the whole BRDF; the model is tried with exact G, Q, R and P_s, which leaves the
error of its approximations, and with every set of tables.
"""

from dataclasses import dataclass
from itertools import product
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np

from coefficients.table import write_whole_bytes
from integrals.hemisphere import base_response, hemisphere_rule, layer_response
from integrals.quadrature import gauss_legendre
from shadefit.refit import require_writable
from shadefit.render_functions import functions, table_sets
from shadefit.terminal import place, print_json, print_table, stages
from shading import (
    ambient_attenuation,
    ambient_layer,
    deferred_radiance,
    direction,
    escape,
    harmonics,
    irradiance,
    mean_radiance,
    roughness_from_spread,
)
from shading.deferred import WRAP

DENSITIES = (0.1, 0.2, 0.5)
SPREADS = (0.05, 0.2, 0.5, 1.0)
TILTS = (0.0, 23.0, 45.0, 90.0)
COSINES = (0.1, 0.2, 0.35, 0.5, 0.7, 0.85, 1.0)
AZIMUTHS = (0.0, 45.0, 90.0, 135.0, 180.0)
# This rule of the hemisphere is good to 1e-4 for the materials above (tests/test_ambient.py).
RULE = {"step": 1 / 10, "azimuths": 96}
PARTS = ("layer", "base")
_NORMAL = np.array([0.0, 0.0, 1.0])
_BATCH = 32


@dataclass(frozen=True)
class Radiances:
    """Radiance of layer and base over the points (n, 5) of (α, θf, d, θv, φv), light by light.

    `exact` and each of `models` map 'layer' and 'base' to (n, lights).
    """

    points: np.ndarray
    lights: tuple[str, ...]
    exact: dict[str, np.ndarray]
    models: dict[str, dict[str, np.ndarray]]


def lights() -> dict[str, np.ndarray]:
    """Give lights as nine harmonics each: uniform, and broad lobes ((1 + ω·s)/2)² about s.

    Such a lobe is of second order exactly, and nowhere negative. The fibre leans to azimuth 0.
    """
    about = {
        "from above": (0.0, 0.0, 1.0),
        "where fibres point": (1.0, 0.0, 0.0),
        "from the side": (0.0, 1.0, 0.0),
        "against fibres": (-1.0, 0.0, 0.0),
    }
    uniform = np.zeros(9)
    uniform[0] = np.sqrt(4 * np.pi)
    return {"uniform": uniform, **{name: _lobe(np.array(s)) for name, s in about.items()}}


def _lobe(axis: np.ndarray) -> np.ndarray:
    """Give the harmonics of ((1 + ω·s)/2)² = 1/3 + (ω·s)/2 + P₂(ω·s)/6 by the addition theorem."""
    legendre = np.repeat([1 / 3, 1 / 2, 1 / 6], [1, 3, 5])
    bands = np.repeat([1.0, 3.0, 5.0], [1, 3, 5])
    return legendre * 4 * np.pi / bands * np.asarray(harmonics(axis))


def points() -> np.ndarray:
    """Give every material and view (n, 5): α, θf, d, θv, φv, angles in radians."""
    every = product(SPREADS, TILTS, DENSITIES, COSINES, AZIMUTHS)
    rows = [
        (roughness_from_spread(s), np.radians(t), d, np.arccos(c), np.radians(a))
        for s, t, d, c, a in every
    ]
    return np.array(rows, float)


def radiances(at: np.ndarray, names: tuple[str, ...] = ()) -> Radiances:
    """Evaluate the exact radiances and the model's at points (n, 5), in all lights.

    `names` are the sets of functions that the model is tried with; by default exact and all tables.
    """
    every = lights()
    harmonic = np.stack(list(every.values()), axis=1)
    materials, which = np.unique(at[:, :3], axis=0, return_inverse=True)
    layer = _layers(at) @ harmonic
    reaching = (_bases(materials) @ harmonic / np.pi)[which]
    exact = {"layer": layer, "base": _escaping(at)[:, None] * reaching}
    models = {name: _model(name, at, harmonic) for name in names or ("exact", *table_sets())}
    return Radiances(at, tuple(every), exact, models)


@jax.jit
def _layer_batches(at):
    return jax.lax.map(lambda x: layer_response(*x, **RULE), at, batch_size=_BATCH)


def _layers(at: np.ndarray) -> np.ndarray:
    return np.asarray(_layer_batches(jnp.asarray(at)))


@jax.jit
def _base_batches(materials):
    def both(x):
        unscattered, scattered = base_response(*x, **RULE)
        return unscattered + scattered

    return jax.lax.map(both, materials, batch_size=_BATCH)


def _bases(materials: np.ndarray) -> np.ndarray:
    return np.asarray(_base_batches(jnp.asarray(materials)))


def _escaping(at: np.ndarray) -> np.ndarray:
    return np.asarray(jax.vmap(escape)(np.cos(at[:, 3]), at[:, 2]))


def _model(name: str, at: np.ndarray, harmonic: np.ndarray) -> dict[str, np.ndarray]:
    """Give the ambient model's radiances with the functions of that name, (n, lights) each."""
    chosen = functions(name)
    mean = mean_radiance(harmonic, _NORMAL)
    received = irradiance(harmonic, _NORMAL)

    def one(alpha, theta_f, density, theta_v, phi):
        cos_v, cos_nt = jnp.cos(theta_v), jnp.cos(theta_f)
        cos_vt = jnp.sin(theta_v) * jnp.cos(phi) * jnp.sin(theta_f) + cos_v * cos_nt
        down = chosen.ps(cos_v, cos_vt, cos_nt, alpha, theta_f)
        layer = ambient_layer(mean, 1.0, chosen.g(density, cos_v), down)
        return layer, (cos_v, density, chosen.q(density))

    layer, (cos_v, density, q) = jax.jit(jax.vmap(one))(*at.T)
    materials, which = np.unique(at[:, :2], axis=0, return_inverse=True)
    r = jax.jit(lambda x: jax.lax.map(lambda m: chosen.r(*m), x))(materials)[which]
    shadow = jax.vmap(ambient_attenuation, (0, 0, None, 0, 0))(cos_v, density, 1.0, q, r)
    return {"layer": np.asarray(layer), "base": np.asarray(shadow[:, None] * received / np.pi)}


def errors(found: Radiances) -> list[dict]:
    """Sum up, light by light: relative rms error of the model with each set of functions.

    Relative to the mean exact radiance of that part in that light. `worst` is the largest error of
    the model with the first functions, relative likewise, and `where` the point.
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
                "where": _where(found.points[worst]),
            }
        )
    return rows


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
        where = _where(found.points[worst])
        rows.append({"what": label, "largest": float(total[worst]), "where": where})
    for albedo in (0.1, 0.2, 0.5):
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


def run(out: Path, as_json: bool) -> None:
    """Measure, print, and write `ambient.png`."""
    from shadefit.ambient_sheet import draw_ambient  # noqa: PLC0415

    require_writable(out)
    with stages() as progress:
        task = progress.add_task("exact radiances by quadrature")
        found = radiances(points())
        progress.update(task, description="picture")
        path = out / "ambient.png"
        write_whole_bytes(path, draw_ambient())
    rows, sums = errors(found), energy(found)
    if as_json:
        print_json({"points": len(found.points), "errors": rows, "energy": sums, "file": str(path)})
        return
    names = list(found.models)
    print_table(
        f"Error of the ambient model over {len(found.points):,} materials and views, "
        "relative to the mean",
        ["part, light", "mean", *(f"rms, {name}" for name in names), "bias", "worst", "at"],
        [
            [
                f"{row['part']}, {row['light']}",
                f"{row['mean']:.4f}",
                *(f"{row['rms'][name]:.2%}" for name in names),
                f"{row['bias']['exact']:+.2%}",
                f"{row['worst']:+.1%}",
                place(row["where"]),
            ]
            for row in rows
        ],
        "White fibres, white base. Columns name whose G, Q, R and P_s the model takes; bias and "
        "worst are with exact ones.",
    )
    print_table(
        "Largest radiance in uniform light of radiance one",
        ["", "largest", "at"],
        [[row["what"], f"{row['largest']:.4f}", place(row["where"])] for row in sums],
        f"Of the same points; {path}.",
    )


def _where(point: np.ndarray) -> dict[str, float]:
    alpha, theta_f, density, theta_v, phi = (float(x) for x in point)
    return {
        "spread": round(alpha**2, 6),
        "tilt": round(float(np.degrees(theta_f)), 6),
        "density": density,
        "cos_v": round(float(np.cos(theta_v)), 6),
        "azimuth": round(float(np.degrees(phi)), 6),
    }
