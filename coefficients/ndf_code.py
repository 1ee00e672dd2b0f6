"""A fitted NDF as shader code in any language, and the check of that code."""

from collections.abc import Callable

import jax
import jax.numpy as jnp
import numpy as np

from coefficients.code_header import cost_text, costs
from coefficients.ndf_table import NdfBlendTable, NdfTable
from integrals.piecewise.smith import hidden_area
from programs import CallSequence, Check, Function, Trial, check, language, precision_of
from programs.printing.comments import command_again
from programs.printing.printer import write_source
from quantities.piecewise.code import ndf_functions
from shading.directions import direction
from shading.piecewise.blend import Blend, weights
from shading.piecewise.ndf import Profile, density, profile
from shading.piecewise.normal_sampling import density_of_normal, sample_normal, sample_polar_angle
from shading.piecewise.visible_sampling import sample_visible_normal, visible_share

# Points at which the code is run, in each direction of the domain.
_POINTS = 4096
# A random number of a blend is put at least so far from where it chooses the other profile. Nearer
# to there rounding decides, and code may rightly differ.
_MARGIN = 1e-3

Values = Callable[[np.ndarray], np.ndarray]


def ndf_of(table: NdfTable | NdfBlendTable) -> Profile | Blend:
    """Return the NDF of a table: one profile, or the blend of two."""
    if isinstance(table, NdfTable):
        return profile(np.array(table.knots), np.array(table.values), table.linear_in)
    x, y = (
        profile(np.array(each.knots), np.array(each.values), table.linear_in)
        for each in (table.x, table.y)
    )
    return Blend(x, y)


def ndf_source(
    table: NdfTable | NdfBlendTable, key: str, precision: str | None = None, name: str = "Ndf"
) -> str:
    """Return the code of an NDF in the language `key`; its knots are an array of constants.

    Its comment states domain, errors and cost. Raises ValueError for an unknown language or
    precision, and for an NDF that is not linear in cos²θ.
    """
    ndf = ndf_of(table)
    kind = precision_of(language(key).key, precision)
    functions = ndf_functions(ndf, name)
    errors = table.errors
    header = {"Quantity": _quantity(table)}
    if isinstance(table, NdfTable):
        header["Use"] = f"H = {name}Hidden is Lambda times the cosine; G1 = NdotV / (NdotV + H)"
    else:
        header["Use"] = (
            f"H = {name}Hidden is Lambda times the cosine; G1 = Vz / (Vz + H). Vectors are unit "
            "vectors in the frame of the surface: x is where the first profile is, z the normal"
        )
    header["Random numbers"] = "uniform in [0, 1)"
    if errors is not None:
        header["Error in exact arithmetic"] = (
            f"total variation {errors.total_variation:.2e}, "
            f"G1 {errors.masking:.2e} at {errors.directions} directions"
        )
    for trial in ndf_trials(ndf, kind, name):
        (each,) = trial.calls.functions
        apart = np.abs(
            trial.emulated(np.float32 if kind != "double" else np.float64)
            - trial.integral.reshape(-1)
        )
        header[f"Rounding of {each.name}"] = f"at most {apart.max():.2e}, emulated in {kind}"
    header["Cost"] = "; ".join(f"{n}: {cost_text(cost)}" for n, cost in costs(functions).items())
    header["Made by"] = command_again(table.command)
    return write_source(functions, key, kind, constants="table", header=header)


def _quantity(table: NdfTable | NdfBlendTable) -> str:
    if isinstance(table, NdfTable):
        kind, knots = "normal distribution", f"{len(table.knots)}"
    else:
        kind = "blend of two normal distributions"
        knots = f"{len(table.x.knots)} and {len(table.y.knots)}"
    return (
        f"{kind} of {table.target}, linear in cos^2 theta between {knots} knots; "
        "integral of D cos is 1"
    )


def ndf_trials(ndf: Profile | Blend, precision: str, name: str = "Ndf") -> list[Trial]:
    """Return a trial of each exported function, with the exact values of the library."""
    functions = ndf_functions(ndf, name)
    rng = np.random.default_rng(0)
    pairs = rng.uniform([1e-3, 0, 1e-3, 0], [1, 2, 1, 2], (_POINTS, 4))
    views = _directions(rng)
    samples = rng.random((len(views), 2))
    if isinstance(ndf, Profile):
        line = np.linspace(0, 1, _POINTS)
        # Cosines near 1 are where narrow NDFs vary, and near 0 where H does.
        cosines = [line, 1 - np.geomspace(1e-7, 1, 1000), np.geomspace(1e-6, 1, 1000)]
        cosines = np.concatenate(cosines)[:, None]
        own = [
            (cosines, _mapped(lambda row: density(ndf, jnp.arccos(row[0])))),
            (cosines, _mapped(lambda row: hidden_area(ndf, jnp.arccos(row[0])))),
            (pairs, _visibility),
            (line[:-1, None], _mapped(lambda row: jnp.sin(sample_polar_angle(ndf, row[0])) ** 2)),
            (np.concatenate([views, samples], axis=1), _visible_normals(ndf)),
        ]
    else:
        share = float(weights(ndf)[0])
        apart = np.stack([_away(samples[:, 0], share), samples[:, 1]], axis=1)
        shares = np.asarray(jax.jit(jax.vmap(visible_share, (None, 0)))(ndf, views))
        seen = np.stack([_away(samples[:, 0], shares), samples[:, 1]], axis=1)
        own = [
            (views, _mapped(lambda row: density_of_normal(ndf, row))),
            (views, _mapped(lambda row: hidden_area(ndf, *_angles(row)))),
            (pairs, _visibility),
            (apart, _mapped(lambda row: sample_normal(ndf, row))),
            (np.concatenate([views, seen], axis=1), _visible_normals(ndf)),
        ]
    return [
        _trial(function, points, precision, exact)
        for function, (points, exact) in zip(functions, own, strict=True)
    ]


def _directions(rng: np.random.Generator) -> np.ndarray:
    """Return directions (k, 3): of all angles, close to the horizon, and the normal itself."""
    half = _POINTS // 2
    theta = np.concatenate(
        [rng.uniform(0, np.pi / 2, half), np.pi / 2 - np.geomspace(1e-5, 1, half)]
    )
    phi = rng.uniform(-np.pi, np.pi, len(theta))
    made = np.asarray(jax.vmap(direction)(theta, phi))
    return np.concatenate([made, [[0.0, 0.0, 1.0]]])


def _away(samples: np.ndarray, share: np.ndarray | float) -> np.ndarray:
    """Return random numbers that are at least a margin away from `share`."""
    moved = np.where(samples < share, share - _MARGIN, share + _MARGIN)
    near = np.abs(samples - share) < _MARGIN
    return np.clip(np.where(near, moved, samples), 0.0, 1 - 2.0**-24)


def _angles(view: jax.Array) -> tuple[jax.Array, jax.Array]:
    return jnp.arctan2(jnp.hypot(view[0], view[1]), view[2]), jnp.arctan2(view[1], view[0])


def _mapped(function: Callable) -> Values:
    mapped = jax.jit(lambda at: jax.lax.map(function, at, batch_size=256))
    return lambda at: np.asarray(mapped(at))


def _visible_normals(ndf: Profile | Blend) -> Values:
    return _mapped(lambda row: sample_visible_normal(ndf, row[:3], row[3:]))


def _visibility(at: np.ndarray) -> np.ndarray:
    v, above, light, below = at.T
    return 0.25 / (v * light + above * light + below * v)


def _trial(function: Function, points: np.ndarray, precision: str, exact: Values) -> Trial:
    calls = CallSequence((function,), lambda points: (points,))
    return Trial(calls, points, precision, exact)


def check_ndf(
    table: NdfTable | NdfBlendTable, key: str, precision: str | None = None, name: str = "Ndf"
) -> dict[str, Check]:
    """Compile and run each function of an NDF in the language `key`; returns checks by its name."""
    kind = precision_of(key, precision)
    trials = ndf_trials(ndf_of(table), kind, name)
    return {trial.calls.functions[0].name: check(trial, key) for trial in trials}
