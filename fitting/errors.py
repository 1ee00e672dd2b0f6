"""How far a form is from its integral on a set of points."""

import functools
from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np

from fitting.form import Form, box_of
from fitting.points.domain import Domain
from fitting.points.grids import off_grid_points
from fitting.points.scattered import COUNTS, spread_points
from integrals import INTEGRALS, Axis, Estimate, Integral

OFF_GRID_SEED = 20200717
# 32² nodes give R to 2e-8 for α ≥ 0.15 (tests/test_errors.py); 96² for lower α.
R_NODES, R_NODES_LOW_ALPHA, R_ALPHA = 32, 96, 0.15
# Points that are evaluated at once.
CHUNK = 8192
CHUNK_OF_R = 64
# From the worst point of each cell, so many along each side of the domain, larger errors are sought
# at these parts of the sides.
CELLS = 4
RADII = (0.05, 0.02, 0.01, 0.005, 0.002, 0.001, 0.0005)


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
    if integral.name != "r":
        return in_chunks(functools.partial(_estimates, integral.name), points, CHUNK)
    nodes = R_NODES if np.min(points[:, 0]) >= R_ALPHA else R_NODES_LOW_ALPHA
    return in_chunks(functools.partial(_estimates, "r", nodes=nodes), points, CHUNK_OF_R)


def form_values(form: Form, points: np.ndarray) -> np.ndarray:
    """Evaluate a form at points (n, axes)."""
    return np.asarray(in_chunks(functools.partial(_apply, form), points, CHUNK))


def measure(
    difference: np.ndarray, points: np.ndarray, domain: type[Form] | Domain, weights=None
) -> Errors:
    """Sum up the differences (n,) between a form and its integral at points (n, axes)."""
    worst = int(np.argmax(np.abs(difference)))
    where = {axis.name: float(x) for axis, x in zip(domain.axes, points[worst], strict=True)}
    rms = float(np.sqrt(np.average(difference**2, weights=weights)))
    return Errors(rms, float(np.abs(difference[worst])), where, len(points))


def off_grid_errors(form: Form) -> Errors:
    """Measure a form on points that no fit sees: see `judge`."""
    return judge(form, type(form))


def judge(form: Form, domain: type[Form] | Domain) -> Errors:
    """Measure a form on a domain: its own, another form's, or what they have in common.

    The rms error is over scrambled Sobol' points. The largest is over these, over points on faces,
    edges and corners of the domain and where the integral is steep, and uphill from the worst.
    """
    points, exact = off_grid_reference(domain)
    inside = measure(form_values(form, points) - exact, points, domain)
    points, exact = check_reference(domain, OFF_GRID_SEED)
    difference = form_values(form, points) - exact
    outside = measure(difference, points, domain)
    found = [inside, outside]
    if COUNTS[domain.integral.name].climbs:

        def error(x: np.ndarray) -> np.ndarray:
            return form_values(form, x) - exact_values(domain.integral, x)

        top = climb(
            lambda x: np.abs(error(x)), points, np.abs(difference), domain.axes, OFF_GRID_SEED
        )
        found.append(measure(error(top), top, domain))
    worst = max(found, key=lambda each: each.largest)
    return Errors(inside.rms, worst.largest, worst.where, inside.points)


def climb(size, points: np.ndarray, sizes: np.ndarray, axes: tuple[Axis, ...], seed: int):
    """Give points (cells, axes) of larger `size`, each near a cell's worst of points (n, axes).

    `size` gives those (m,) of points (m, axes), and `sizes` are those of `points`. The largest
    error may be on a ridge that few points are on: it is sought nearer to them in every round.
    """
    lower, upper = box_of(axes).T
    rng = np.random.default_rng(seed)
    cells = np.ravel_multi_index(
        np.minimum(CELLS * (points - lower) / (upper - lower), CELLS - 1).astype(int).T,
        (CELLS,) * len(axes),
    )
    order = np.argsort(sizes)
    worst = np.full(CELLS ** len(axes), -1)
    worst[cells[order]] = order
    best = points[worst[worst >= 0]]
    for radius in RADII:
        steps = rng.normal(size=(CHUNK // len(best), *best.shape)) * radius * (upper - lower)
        steps[0] = 0
        tried = np.clip(best + steps, lower, upper)
        found = np.argmax(size(tried.reshape(-1, len(axes))).reshape(tried.shape[:2]), axis=0)
        best = tried[found, np.arange(len(best))]
    return best


def off_grid_reference(domain: type[Form] | Domain) -> tuple[np.ndarray, np.ndarray]:
    """Give the off-grid points (n, axes) of a form's domain and the exact values (n,) there."""
    return _off_grid(domain.integral.name, domain.axes)


@functools.lru_cache(maxsize=16)
def _off_grid(name: str, axes: tuple[Axis, ...]) -> tuple[np.ndarray, np.ndarray]:
    points = off_grid_points(axes, COUNTS[name].judged, OFF_GRID_SEED)
    return points, exact_values(INTEGRALS[name], points)


def in_chunks(function, points: np.ndarray, chunk: int):
    """Apply a function of (chunk, axes) to points (n, axes): it is compiled once for any n."""
    count = len(points)
    padded = np.concatenate([points, np.repeat(points[-1:], -count % chunk, axis=0)])
    parts = [function(padded[first : first + chunk]) for first in range(0, count, chunk)]
    return jax.tree.map(lambda *each: jnp.asarray(np.concatenate(each)[:count]), *parts)


def check_reference(domain: type[Form] | Domain, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Give points (n, axes) all over a form's domain, its boundary included, and exact values."""
    return _check(domain.integral.name, domain.axes, seed)


@functools.lru_cache(maxsize=16)
def _check(name: str, axes: tuple[Axis, ...], seed: int) -> tuple[np.ndarray, np.ndarray]:
    points = spread_points(name, axes, COUNTS[name].checked, seed)
    return points, exact_values(INTEGRALS[name], points)


@functools.partial(jax.jit, static_argnums=0, static_argnames="nodes")
def _estimates(name: str, points, **options) -> Estimate:
    integral = INTEGRALS[name]
    leg = integral.legs[integral.reference]
    return jax.vmap(lambda x: leg(*x, **options))(points)


@jax.jit
def _apply(form: Form, points):
    return jax.vmap(lambda x: form(*x))(points)
