"""What is drawn: exact values and those of the exported functions, on grids of arguments."""

from functools import lru_cache

import numpy as np

from coefficients.catalogue import AS_PRINTED, load, names
from coefficients.shaders import Shader, shader
from fitting import exact_values
from integrals import INTEGRALS, Integral
from programs.program import evaluate
from programs.tracing.tracer import trace

_FOLDERS = {"published": "published", "best": "best", "": "refitted", "refit": "refitted"}


def quantities() -> list[str]:
    """List the quantities that have a published table, which the others are held against."""
    known = names()
    return [name for name in INTEGRALS if f"published/{name}" in known]


def tables_of(quantity: str) -> list[str]:
    """List the named tables of a quantity: published as printed, published, then all others."""
    found = [name for name in names() if of_quantity(name) == quantity]
    order = {"printed": 0, "published": 1, "refitted": 2, "best": 3}
    return sorted(found, key=lambda name: (order[kind_of(name)], name))


@lru_cache(maxsize=256)
def of_quantity(name: str) -> str:
    """Name the quantity that a table is of."""
    return load(name).quantity


def kind_of(name: str) -> str:
    """Tell what a table is: 'printed', 'published', 'refitted' or 'best'."""
    folder = name.rpartition("/")[0]
    return "printed" if name.endswith(AS_PRINTED) else _FOLDERS[folder]


def mesh(*axes: np.ndarray) -> np.ndarray:
    """Give the points (…, axes) of a tensor grid, one array of its shape an axis behind another."""
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)


def exact(integral: Integral, points: np.ndarray) -> np.ndarray:
    """Evaluate an integral at points (…, axes): (…)."""
    return exact_values(integral, points.reshape(-1, points.shape[-1])).reshape(points.shape[:-1])


def exported(name: str, points: np.ndarray) -> np.ndarray:
    """Evaluate a table's exported functions, clamps and all, in float64 at points (…, axes): (…).

    The functions are called one after the other, as a renderer calls them.
    """
    chosen, flat = _loaded(name), points.reshape(-1, points.shape[-1])
    results = np.empty((len(flat), 0))
    for program, own in zip(_programs(name), chosen.columns(flat), strict=True):
        results = evaluate(program, np.concatenate([results, own], axis=1))
    return results[:, 0].reshape(points.shape[:-1])


@lru_cache(maxsize=256)
def _loaded(name: str) -> Shader:
    return shader(name, "double")


@lru_cache(maxsize=256)
def _programs(name: str):
    return tuple(trace(function) for function in _loaded(name).functions)
