"""Fits of the constants of `shading.lit_fraction` to E_lit, and of the ambient models to radiance.

The points are Sobol' points of this module. No point at which docs/brdf.md judges the models is
among them. `lit_fraction` is fitted to exact E_lit. Each model is fitted to the radiance in twelve
lights, relative to the mean radiance in each: a uniform light, and eleven broad lobes
(`shading.harmonics.LOBE`). `python -m quantities.fuzz.ambient_fit` makes all these fits and prints
the constants.
"""

import functools
from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from fitting.points.grids import sobol_points
from fitting.solvers.descent import Descent, descend
from integrals import PS, G
from integrals.fuzz.lit import E_LIT
from integrals.fuzz.radiance import layer_response
from integrals.reference import Axis
from quantities.fuzz.ambient_range import least_variances
from quantities.fuzz.lit_forms import seen
from shading import (
    AMBIENT_MODELS,
    AmbientModel,
    LayerView,
    direction,
    fiber_direction,
    harmonics,
    light_weights,
)
from shading.fuzz.ambient import lit_by_constants
from shading.harmonics import LOBE, UNIFORM

# What the points fill evenly; the density evenly in its logarithm. The fibre leans to azimuth 0.
AXES = (
    Axis("alpha", 0.05, 1.0),
    Axis("theta_f", 0.0, np.pi / 2),
    Axis("log_density", np.log(0.01), np.log(0.5)),
    Axis("cos_vn", 0.05, 1.0),
    Axis("phi", 0.0, np.pi),
)
EXPONENT, SEED = 12, 20261129
# Those of `lit_fraction`
LIT_AXES = (Axis("alpha", 0.15, 1.0), *(AXES[k] for k in (1, 3, 4)))
LIT_EXPONENT, LIT_START = 13, (1.0, 0.5)
# The rule for exact radiances. With the double number of nodes, the constants are the same to the
# digits that are kept.
RULE = {"step": 1 / 12, "azimuths": 240}
_BATCH = 16
# The weight of the uniform light, in which an error is seen most.
_UNIFORM = 2.0
# A least variance of the light below the first number is penalised by its lack times the second.
_LEAST_VARIANCE, _PENALTY = 5e-3, 100.0
# A fit ends if a step lowers the sum of squares by less than this part.
_WORTHWHILE = 1e-12

# The axes s of the lobes, not normalised: the normal, the horizon, and about 45° above it.
LOBES = (
    *((0, 0, 1), (1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (1, 0, 1), (-1, 0, 1)),
    *((1, 1, 1.4), (-1, 1, 1.4), (1, -1, 1.4), (-1, -1, 1.4)),
)


@dataclass(frozen=True)
class FittedModel:
    """The constants of an ambient model by least squares.

    * `constants`: in the order of the model's. `converged`: whether the fit ended at a minimum.
    * `rms`: for each light, the rms error relative to the mean radiance, at the fitted points.
    """

    constants: tuple[float, ...]
    converged: bool
    rms: tuple[float, ...]


@dataclass(frozen=True)
class Samples:
    """Views of layers (n,), the vectors v and t (n, 3), and exact weights of harmonics (n, 9)."""

    view: LayerView
    views: np.ndarray
    fibers: np.ndarray
    weights: np.ndarray


def samples(exponent: int = EXPONENT, seed: int = SEED) -> Samples:
    """Return exact values at 2^`exponent` points of this module."""
    alpha, theta_f, logarithm, cos_vn, phi = sobol_points(AXES, exponent, seed).T
    return samples_at(np.stack([alpha, theta_f, np.exp(logarithm), np.arccos(cos_vn), phi], axis=1))


def samples_at(points: np.ndarray) -> Samples:
    """Return exact values at points (n, 5): α, θf, d, θv and φv; angles in radians."""
    columns = jnp.asarray(points)
    view, views, fibers, weights = jax.tree.map(np.asarray, _exact(columns))
    return Samples(view, views, fibers, weights)


@jax.jit
def _exact(points: Array):
    return jax.lax.map(_exact_at, points, batch_size=_BATCH)


def _exact_at(point: Array):
    alpha, theta_f, density, theta_v, phi = point
    view, fiber = direction(theta_v, phi), fiber_direction(theta_f)
    place = LayerView(
        cos_vn=view[2],
        cos_vt=view @ fiber,
        cos_nt=fiber[2],
        alpha=alpha,
        density=density,
        scattering=G.value(density, view[2]),
        scattered=PS.value(alpha, theta_f, theta_v, phi),
    )
    return place, view, fiber, layer_response(*point, **RULE)


def fitting_lights() -> np.ndarray:
    """Return the harmonics (9, 12) of the lights that models are fitted to."""
    axes = np.array(LOBES) / np.linalg.norm(LOBES, axis=1)[:, None]
    return np.column_stack([UNIFORM, (LOBE * np.asarray(jax.vmap(harmonics)(axes))).T])


def model_weights(model: AmbientModel, at: Samples, constants=None) -> Array:
    """Return the weights (n, 9) of the nine harmonics by a model, with its or other constants."""
    k = model.constants if constants is None else tuple(constants)

    def one(view, v, t):
        return light_weights(model.light(view, k), jnp.array([0.0, 0.0, 1.0]), v, t)

    return jax.vmap(one)(at.view, at.views, at.fibers)


def radiance_errors(
    model: AmbientModel, at: Samples, lights: np.ndarray, constants=None
) -> np.ndarray:
    """Return the rms error of a model in lights (9, m), relative to the mean radiance in each."""
    exact = at.weights @ lights
    off = np.asarray(model_weights(model, at, constants)) @ lights - exact
    return np.sqrt(np.mean(off**2, axis=0)) / exact.mean(axis=0)


def fit_model(model: AmbientModel, at: Samples, start=None) -> FittedModel:
    """Fit the constants of a model to exact values, from its constants or another start.

    A model that does not know where the light comes from is fitted to uniform light only. A model
    whose radiance could be negative is penalised (`ambient_range`). Constants that are those of a
    simpler model stay as they are.
    """
    lights = fitting_lights()[:, : None if model.directed else 1]
    scaled = lights / (at.weights @ lights).mean(axis=0) / np.sqrt(len(at.weights))
    scaled[:, 0] *= _UNIFORM

    given = jnp.asarray(model.constants if start is None else start)
    fixed, free = given[: model.shared], given[model.shared :]

    def residual(k):
        weights = model_weights(model, at, jnp.concatenate([fixed, k]))
        short = jnp.maximum(_LEAST_VARIANCE - least_variances(weights), 0)
        lack = _PENALTY / np.sqrt(len(weights)) * short
        return jnp.concatenate([((weights - at.weights) @ scaled).ravel(), lack])

    compiled, slopes = jax.jit(residual), jax.jit(jax.jacfwd(residual))
    end = descend(
        lambda z: np.asarray(compiled(z)),
        lambda z: np.asarray(slopes(z)),
        np.asarray(free),
        worthwhile=_WORTHWHILE,
    )
    constants = (*map(float, fixed), *map(float, end.z))
    rms = radiance_errors(model, at, lights, constants)
    return FittedModel(constants, end.converged, tuple(map(float, rms)))


def fit_lit_fraction(exponent: int = LIT_EXPONENT) -> Descent:
    """Fit the two constants of `shading.lit_fraction` to exact E_lit at 2^`exponent` points."""
    alpha, theta_f, cos_vn, phi = sobol_points(LIT_AXES, exponent, SEED).T
    points = np.stack([alpha, theta_f, np.arccos(cos_vn), phi], axis=1)
    exact = E_LIT.values(points)
    cos_vt, scattered = jax.jit(jax.vmap(seen))(*points.T)
    by_constants = jax.vmap(lit_by_constants, in_axes=(None, 0, 0, 0))

    def residual(k):
        return by_constants(tuple(k), 1 - scattered, cos_vt, alpha) - exact

    compiled, slopes = jax.jit(residual), jax.jit(jax.jacfwd(residual))
    return descend(
        lambda z: np.asarray(compiled(z)), lambda z: np.asarray(slopes(z)), np.array(LIT_START)
    )


@functools.cache
def fitted_models() -> dict[str, FittedModel]:
    """Return the fits of all models that have constants, by name."""
    at = samples()
    return {name: fit_model(model, at) for name, model in AMBIENT_MODELS.items() if model.constants}


def main() -> None:
    """Print the fitted constants of all models and their errors."""
    jax.config.update("jax_enable_x64", True)
    lit = fit_lit_fraction()
    print("lit_fraction", "converged" if lit.converged else "did not converge")
    print("  constants", ", ".join(f"{each:.4f}" for each in lit.z))
    for name, fitted in fitted_models().items():
        print(name, "converged" if fitted.converged else "did not converge")
        print("  constants", ", ".join(f"{each:.4f}" for each in fitted.constants))
        print("  rms, % of the mean", ", ".join(f"{100 * each:.2f}" for each in fitted.rms))


if __name__ == "__main__":
    main()
