"""A fitted NDF as shader code in any language, and the check of that code."""

from collections.abc import Callable

import jax
import numpy as np

from coefficients.code_header import cost_text, costs
from coefficients.ndf_table import NdfTable
from integrals.piecewise.smith import hidden_area
from programs import CallSequence, Check, Function, Trial, check, language, precision_of
from programs.printing.printer import write_source
from quantities.piecewise.code import ndf_functions
from shading.piecewise.ndf import Profile, density, profile
from shading.piecewise.normal_sampling import sample_polar_angle

# Points at which the code is run, in each direction of the domain.
_POINTS = 4096


def profile_of(table: NdfTable) -> Profile:
    """Return the NDF of a table."""
    return profile(np.array(table.knots), np.array(table.values), table.linear_in)


def ndf_source(table: NdfTable, key: str, precision: str | None = None, name: str = "Ndf") -> str:
    """Return the code of an NDF in the language `key`; its knots are an array of constants.

    Its comment states domain, errors and cost. Raises ValueError for an unknown language or
    precision, and for an NDF that is not linear in cos²θ.
    """
    ndf = profile_of(table)
    kind = precision_of(language(key).key, precision)
    functions = ndf_functions(ndf, name)
    errors = table.errors
    header = {
        "Quantity": f"normal distribution of {table.target}, linear in cos^2 theta between "
        f"{len(table.knots)} knots; integral of D cos is 1",
        "Use": f"H = {name}Hidden is Lambda times the cosine; G1 = NdotV / (NdotV + H)",
        "Error in exact arithmetic": f"total variation {errors.total_variation:.2e}, "
        f"G1 {errors.masking:.2e} at {errors.directions} directions",
    }
    for trial in ndf_trials(ndf, kind, name):
        (each,) = trial.calls.functions
        apart = np.abs(
            trial.emulated(np.float32 if kind != "double" else np.float64) - trial.integral
        )
        header[f"Rounding of {each.name}"] = f"at most {apart.max():.2e}, emulated in {kind}"
    header["Cost"] = "; ".join(f"{n}: {cost_text(cost)}" for n, cost in costs(functions).items())
    header["Made by"] = table.command
    return write_source(functions, key, kind, constants="table", header=header)


def ndf_trials(ndf: Profile, precision: str, name: str = "Ndf") -> list[Trial]:
    """Return a trial of each exported function, with the exact values of the library."""
    shape, hidden, visibility, sine = ndf_functions(ndf, name)
    line = np.linspace(0, 1, _POINTS)
    # Cosines near 1 are where narrow NDFs vary, and near 0 where H does.
    cosines = np.concatenate([line, 1 - np.geomspace(1e-7, 1, 1000), np.geomspace(1e-6, 1, 1000)])
    rng = np.random.default_rng(0)
    pairs = rng.uniform([1e-3, 0, 1e-3, 0], [1, 2, 1, 2], (_POINTS, 4))

    def direct(at: np.ndarray) -> np.ndarray:
        v, above, light, below = at.T
        return 0.25 / (v * light + above * light + below * v)

    def of_angle(function: Callable) -> Callable[[np.ndarray], np.ndarray]:
        mapped = jax.jit(lambda at: jax.lax.map(function, at, batch_size=256))
        return lambda at: np.asarray(mapped(np.arccos(at[:, 0])))

    def sines(at: np.ndarray) -> np.ndarray:
        drawn = jax.jit(jax.vmap(lambda xi: sample_polar_angle(ndf, xi)))(at[:, 0])
        return np.sin(np.asarray(drawn)) ** 2

    return [
        _trial(shape, cosines[:, None], precision, of_angle(lambda theta: density(ndf, theta))),
        _trial(hidden, cosines[:, None], precision, of_angle(lambda at: hidden_area(ndf, at))),
        _trial(visibility, pairs, precision, direct),
        _trial(sine, line[:-1, None], precision, sines),
    ]


def _trial(function: Function, points: np.ndarray, precision: str, exact: Callable | None) -> Trial:
    calls = CallSequence((function,), lambda points: (points,))
    return Trial(calls, points, precision, exact)


def check_ndf(table: NdfTable, key: str, precision: str | None = None) -> list[Check]:
    """Compile and run each function of an NDF in the language `key`, and compare it."""
    kind = precision_of(key, precision)
    return [check(trial, key) for trial in ndf_trials(profile_of(table), kind)]
