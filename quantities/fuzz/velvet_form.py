"""The form r̃ of r(k), which is proven not to be above the exact factor, so it creates no energy.

r = s/B(x) with x = −k, s = √(1 − x²), and a smooth function B with B(0) = 1. The form is r̃ = s/B̃
with B̃ = 1 + x (c₀ + c₁x + c₂(1 − s)), which has to be an upper bound of B. The condition B̃ ≥ B and
the relative loss (r − r̃)/r̃ = B̃/B − 1 are linear in the coefficients, so the fit is a linear
program.
"""

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from fitting.form import FittedForm, Form, Proofs, Stage
from fitting.goal import Goal
from fitting.points.grids import Grid, trapezoid_grid
from fitting.solvers.on_grid import OnGrid
from integrals import VELVET
from integrals.compilation import jit_for_few_calls
from integrals.fuzz.velvet import normalisation, series_coefficients
from integrals.reference import restricted
from programs.bounding.denominators import DenominatorBound, bound_below
from programs.functions import Function, Parameter
from programs.tracing.tracer import trace
from shading.types import Scalar

# (B̃ − B)/x is made at least this at the points between the nodes. It is far larger than rounding
# errors, and far smaller than the loss of r̃.
MARGIN = 1e-6
# The number of these points. That B̃ ≥ B between them too is proven by the certificate.
_LIFT_NODES = 4097
# The closed form of B loses digits by cancellation as x → 0. For x = sin φ < ¼ the proof uses the
# power series of B.
_SERIES_LIMIT = float(np.arcsin(0.25))
_SERIES_TERMS = 24

AXES = restricted(VELVET.axes, asymmetry=(-0.95, 0.0))

_norms = jit_for_few_calls(jax.vmap(normalisation))


def _value(c, asymmetry: Scalar) -> Array:
    # notation: x, s, c₀ … c₂ as above
    x = -jnp.asarray(asymmetry)
    s = jnp.sqrt((1 - x) * (1 + x))
    return s / (1 + x * (c[0] + c[1] * x + c[2] * (1 - s)))


def fit_conservative_norm(grid: Grid, exact: Array) -> Array:
    """Return the coefficients (3,) that minimise the largest relative loss (r − r̃)/r̃ with r̃ ≤ r.

    A linear program does so at the nodes of a grid of k. Then c₀ is raised until r̃ is below r
    between the nodes too.
    """
    from scipy.optimize import linprog  # noqa: PLC0415  slow to import

    k = grid.points[:, 0]
    keep = k < 0
    x, r = -k[keep], np.asarray(exact)[keep]
    smooth = np.sqrt((1 - x) * (1 + x)) / r  # B
    terms = _terms(x)
    upper = np.concatenate([x[:, None] * terms / smooth[:, None], -np.ones((len(x), 1))], axis=1)
    lower = np.concatenate([-terms, np.zeros((len(x), 1))], axis=1)
    solved = linprog(
        np.array([0.0, 0.0, 0.0, 1.0]),
        np.concatenate([upper, lower]),
        np.concatenate([1 - 1 / smooth, -(smooth - 1) / x]),
        bounds=[(None, None)] * 3 + [(0, None)],
    )
    if not solved.success:
        raise ValueError(f"r(k) on {len(k)} nodes: the linear program says {solved.message!r}")
    coefficients = solved.x[:3]
    dense = -AXES[0].lower * np.linspace(1, _LIFT_NODES, _LIFT_NODES) / _LIFT_NODES
    exact_b = np.sqrt((1 - dense) * (1 + dense)) / np.asarray(_norms(-dense))
    room = np.min(_terms(dense) @ coefficients - (exact_b - 1) / dense)
    return jnp.asarray(coefficients + np.array([MARGIN - room, 0, 0]))


def certify_conservative(fitted: FittedForm) -> DenominatorBound:
    """Bound (B̃ − B)/x from below on the form's domain. A positive bound proves r̃ ≤ r.

    At k = 0 both r̃ and r are 1. The variable is φ = arcsin x. In it s = cos φ, so that B consists
    of sines, cosines and a division, which have interval versions. Near φ = 0, B is replaced by an
    upper bound: its power series, with a bound of the terms that are left out.
    """
    end = float(np.arcsin(-fitted.axes[0].lower))
    pieces = [(_near_zero, 0.0, min(_SERIES_LIMIT, end)), (_beyond, min(_SERIES_LIMIT, end), end)]
    certificates = []
    for rest, low, high in pieces:

        def room(phi, rest=rest):
            return _room(fitted, rest, phi)

        parameters = (Parameter("phi", (low, high), "rad"),)
        program = trace(Function("room", "B̃ − B over x.", parameters, None, "value", room))
        certificates.append(bound_below(program, np.array([[low, high]])))
    return DenominatorBound(
        min(each.bound for each in certificates), sum(each.boxes for each in certificates)
    )


def _terms(x: np.ndarray) -> np.ndarray:
    return np.stack([np.ones_like(x), x, 1 - np.sqrt((1 - x) * (1 + x))], axis=1)


def _room(fitted: FittedForm, rest, phi):
    """Return (B̃ − B)/x at x = sin φ. `rest` is a function that returns (B − 1)/x."""
    c, x, s = fitted.constants, jnp.sin(phi), jnp.cos(phi)
    return c[0] + c[1] * x + c[2] * (1 - s) - rest(phi, x, s)


def _near_zero(_, x, s):
    """Return an upper bound of (B − 1)/x for x ≤ sin _SERIES_LIMIT, by the power series of B.

    B = s³ Σ aₙxⁿ with a₀ = 1 (`series_coefficients`). Because aₙ₊₁/aₙ < (n + 2)/(n + 1), the terms
    that are left out are bounded by a geometric series.
    """
    a, limit = series_coefficients(_SERIES_TERMS + 1), np.sin(_SERIES_LIMIT)
    last = len(a) - 1
    total = a[last] / (1 - limit * (last + 2) / (last + 1))
    for coefficient in a[last - 1 : 0 : -1]:
        total = coefficient + x * total
    return s * s * s * total - x * (1 + s + s * s) / (1 + s)


def _beyond(phi, x, s):
    """Return (B − 1)/x from B = (2/(πx²)) ((π + 2φ)(2x² − 1) + 2xs + πs³)."""
    a = np.pi + 2 * phi
    b = (2 / np.pi) * (a * (2 * x * x - 1) + 2 * x * s + np.pi * s * s * s) / (x * x)
    return (b - 1) / x


CONSERVATIVE_NORM = Form(
    name="conservative-norm",
    equation="x = −k; s = √((1 − x)·(1 + x)); r = s/(1 + x·(c0 + c1·x + c2·(1 − s)))",
    reference=VELVET,
    axes=AXES,
    coefficient_names=["c0: x", "c1: x²", "c2: x(1 − s)"],
    stages=(Stage(_value),),
    proofs=Proofs(below=lambda fitted: certify_conservative(fitted).bound),
    solver=OnGrid(
        trapezoid_grid,
        fit_conservative_norm,
        "linear program (HiGHS)",
        Goal(norm="linf", relative=True, side="below"),
    ),
)
