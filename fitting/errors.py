"""How far a form is from its integral on a set of points."""

import functools
from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np

from fitting.form import Form
from fitting.grid import off_grid_points
from integrals import INTEGRALS, Estimate, Integral

# log₂ of the size of the off-grid set: R, which has no closed form, is dear.
OFF_GRID_EXPONENT = {"ps": 17, "g": 16, "q": 16, "r": 12}
OFF_GRID_SEED = 20200717
# 32² nodes give R to 2e-8 for α ≥ 0.15 (tests/test_errors.py).
LEG_OPTIONS = {"r": {"nodes": 32}}
# Points that are evaluated at once.
CHUNK = 8192
CHUNK_OF_R = 64


@dataclass(frozen=True)
class Errors:
    """The rms error, the largest in absolute value, and where that is (axis name → value)."""

    rms: float
    largest: float
    where: dict[str, float]
    points: int


def exact_values(integral: Integral, points: np.ndarray) -> np.ndarray:
    """Evaluate the integral's reference leg at points (n, axes)."""
    return np.asarray(exact_estimates(integral, points).value)


def exact_estimates(integral: Integral, points: np.ndarray) -> Estimate:
    """Evaluate the same with the error that the leg states, both (n,)."""
    chunk = CHUNK_OF_R if integral.name == "r" else CHUNK
    return _in_chunks(functools.partial(_estimates, integral.name), points, chunk)


def form_values(form: Form, points: np.ndarray) -> np.ndarray:
    """Evaluate a form at points (n, axes)."""
    return np.asarray(_in_chunks(functools.partial(_apply, form), points, CHUNK))


def measure(difference: np.ndarray, points: np.ndarray, form: type[Form], weights=None) -> Errors:
    """Sum up the differences (n,) between a form and its integral at points (n, axes)."""
    worst = int(np.argmax(np.abs(difference)))
    where = {axis.name: float(x) for axis, x in zip(form.axes, points[worst], strict=True)}
    rms = float(np.sqrt(np.average(difference**2, weights=weights)))
    return Errors(rms, float(np.abs(difference[worst])), where, len(points))


def off_grid_errors(form: Form) -> Errors:
    """Measure a form on scrambled Sobol' points of its domain, which no fit sees."""
    points, exact = off_grid_reference(type(form))
    return measure(form_values(form, points) - exact, points, type(form))


@functools.lru_cache(maxsize=16)
def off_grid_reference(form: type[Form]) -> tuple[np.ndarray, np.ndarray]:
    """Give the off-grid points (n, axes) of a form's domain and the exact values (n,) there."""
    points = off_grid_points(form.axes, OFF_GRID_EXPONENT[form.integral.name], OFF_GRID_SEED)
    return points, exact_values(form.integral, points)


def _in_chunks(function, points: np.ndarray, chunk: int):
    """Apply a function of (chunk, axes) to points (n, axes): it is compiled once for any n."""
    count = len(points)
    padded = np.concatenate([points, np.repeat(points[-1:], -count % chunk, axis=0)])
    parts = [function(padded[first : first + chunk]) for first in range(0, count, chunk)]
    return jax.tree.map(lambda *each: jnp.asarray(np.concatenate(each)[:count]), *parts)


@functools.partial(jax.jit, static_argnums=0)
def _estimates(name: str, points) -> Estimate:
    integral = INTEGRALS[name]
    leg = integral.legs[integral.reference]
    return jax.vmap(lambda x: leg(*x, **LEG_OPTIONS.get(name, {})))(points)


@jax.jit
def _apply(form: Form, points):
    return jax.vmap(lambda x: form(*x))(points)
