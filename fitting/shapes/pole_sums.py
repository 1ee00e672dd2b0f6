"""Forms that are a polynomial and simple poles outside the domain."""

import math
from collections.abc import Callable

import jax.numpy as jnp
import numpy as np
from jax import Array

from fitting.equation import equation_of
from fitting.form import Form, Stage
from fitting.shapes.monomial_sums import free_letter, sum_text
from fitting.shapes.poles import poles_value
from fitting.shapes.variables import variables_of
from integrals.reference import Axis, Reference

# Distances of the first and of the last pole from the lower end of the domain, as parts of its
# width, in the starts of a fit.
_DISTANCES = ((0.9, 1e-3), (0.5, 2e-2), (3.0, 5e-2))
# The least value of a variable is sought at this many values of each axis.
_PROBES = 65


def pole_sum(
    reference: Reference,
    poles: int,
    degree: int,
    *,
    name: str,
    axes: tuple[Axis, ...] | None = None,
    of: Callable | None = None,
) -> Form:
    """Return the form Σ cₖ zᵏ + Σ aₖ/(bₖ + z): a polynomial of a `degree`, and simple poles.

    A degree of −1 leaves the polynomial out. z is the axis, or what `of` computes of axes by name.
    A fit keeps all bₖ + z positive, so that the poles z = −bₖ are below the domain. Raises
    ValueError for more than one variable, and for a form without coefficients.
    """
    axes = reference.axes if axes is None else axes
    variables = variables_of(of, axes)
    if len(variables.symbols) != 1:
        shown = ", ".join(variables.symbols)
        raise ValueError(f"{name} has the variables {shown}: allowed is one, by of=…")
    if poles < 0 or degree < -1 or poles + degree < 0:
        raise ValueError(f"{name}: {poles} poles, degree {degree}: it has no coefficients")
    (z,), terms = variables.symbols, degree + 1
    taken = [z, *(text for axis in axes for text in (axis.name, axis.symbol))]
    a = free_letter("a", taken)
    b = free_letter("b", [*taken, f"{a}1"])
    c = free_letter("c", [*taken, f"{a}1", f"{b}1"])
    names = [f"{c}{k}" for k in range(terms)]
    text = [sum_text({(k,): each for k, each in enumerate(names)}, [z])] if terms else []
    text += [f"{a}{k}/({b}{k} + {z})" for k in range(1, poles + 1)]
    names += [f"{letter}{k}" for k in range(1, poles + 1) for letter in (a, b)]

    def value(coefficients, *point) -> Array:
        return poles_value(coefficients, terms, poles, jnp.asarray(variables.at(*point)[0]))

    starts = _starts(terms, poles, *_ends(variables.at, axes)) if poles else ()
    equation = equation_of(reference.symbol, " + ".join(text), variables.definitions)
    return Form(name, equation, reference, axes, names, (Stage(value),), starts=starts)


def _starts(terms: int, poles: int, lower: float, width: float) -> tuple[np.ndarray, ...]:
    found = []
    for far, near in _DISTANCES:
        distances = np.geomspace(far, near, poles) if poles > 1 else np.array([far])
        pairs = np.stack([np.zeros(poles), distances * width - lower], axis=1)
        found.append(np.concatenate([np.zeros(terms), pairs.ravel()]))
    return tuple(found)


def _ends(at: Callable, axes: tuple[Axis, ...]) -> tuple[float, float]:
    """Return the least value of the variable at some points, and the width of its values."""
    lines = []
    for axis in axes:
        upper = axis.upper if math.isfinite(axis.upper) else axis.lower + 1
        lines.append(np.linspace(axis.lower, upper, _PROBES if len(axes) < 3 else 5))
    grids = np.meshgrid(*lines, indexing="ij")
    with np.errstate(all="ignore"):
        values = np.asarray(at(*grids)[0], float)
    good = np.broadcast_to(values, grids[0].shape)
    good = good[np.isfinite(good)]
    if not len(good) or good.max() == good.min():
        return 0.0, 1.0
    return float(good.min()), float(good.max() - good.min())
