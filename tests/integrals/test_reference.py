"""References: known values by every leg, domains, arguments, float64, batches; and axes."""

import functools
import subprocess
import sys

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from integrals import PS, REFERENCES, Axis, Estimate, R, Reference, Sampling
from integrals.reference import box_of, leg, require_float64, restricted
from tests.integrals.problems import KNOWN_VALUES, RIGHT

# A correct Monte Carlo estimate exceeds this many standard errors once in 1.7 million trials.
STANDARD_ERRORS = 5
# The known values are themselves evaluated in float64, with an error of a few roundings of 1.
KNOWN_ROUNDING = 1e-15

LEGS = [(name, leg) for name, reference in REFERENCES.items() for leg in reference.legs]
SKIN = [f"skin-{s}-{c}" for s in ("cylinder", "sphere") for c in ("red", "green", "blue")]
LOBES = ["skin-lobe-cylinder", "skin-lobe-sphere"]
BANDS = [f"skin-band-{b}-{c}" for b in (1, 2) for c in ("red", "green", "blue")]
INSIDE = {
    "ps": (0.5, 0.6, 0.7, 0.8),
    "g": (0.5, 0.6),
    "q": (0.5,),
    "r": (0.5, 0.6),
    "velvet": (-0.5,),
    "ggx-directional-albedo": (0.5, 0.5),
    "ggx-scale": (0.5, 0.5),
    "ggx-bias": (0.5, 0.5),
    "ggx-average-albedo": (0.5,),
    "sggx-filter": (0.5,),
    "sggx-filter-axes": (0.5, 0.25),
    **dict.fromkeys(SKIN, (0.5, 0.2)),
    **dict.fromkeys(LOBES, (0.5, 0.2)),
    **dict.fromkeys(BANDS, (0.2,)),
}


# A and B have as few azimuths, and the width along axes as few nodes, as fits need. The samples of
# the width enter through a root, whose slope is small.
LARGER_ERRORS = {
    ("ggx-scale", "quadrature"): 1e-9,
    ("ggx-bias", "quadrature"): 1e-9,
    ("sggx-filter-axes", "quadrature"): 1e-6,
    ("sggx-filter", "monte_carlo"): 1e-2,
    ("sggx-filter-axes", "monte_carlo"): 1e-2,
}


@functools.cache
def evaluator(name, leg):
    return jax.jit(REFERENCES[name].legs[leg])


# A and B take seconds, and E has the same rule.
SLOW = ("ggx-scale", "ggx-bias")


@pytest.mark.parametrize(
    ("name", "leg"),
    [pytest.param(*each, marks=pytest.mark.slow if each[0] in SLOW else ()) for each in LEGS],
)
def test_every_leg_gives_the_known_values_within_its_stated_error(name, leg):
    allowed = STANDARD_ERRORS if leg == "monte_carlo" else 1
    known_values = [known for known in KNOWN_VALUES if known.quantity == name]
    assert known_values
    for known in known_values:
        value, error = evaluator(name, leg)(*map(float, known.arguments))
        miss = abs(float(value) - known.exact)
        assert miss <= allowed * float(error) + KNOWN_ROUNDING, (known, value, error)


@pytest.mark.parametrize(("name", "leg"), LEGS)
def test_stated_errors_are_small(name, leg):
    """A leg that states a large error would pass the other tests, but would be useless."""
    value, error = evaluator(name, leg)(*INSIDE[name])
    assert isinstance(evaluator(name, leg)(*INSIDE[name]), Estimate)
    rule = LARGER_ERRORS.get((name, leg), 5e-3 if leg == "monte_carlo" else 1e-12)
    assert 0 < float(error) < rule
    low, high = REFERENCES[name].codomain
    assert low < float(value) < high


@pytest.mark.parametrize(("name", "leg"), LEGS)
def test_every_leg_is_nan_outside_the_domain(name, leg):
    reference = REFERENCES[name]
    for index, axis in enumerate(reference.axes):
        above = np.nextafter(axis.upper, np.inf)
        at_lower = axis.lower if axis.open_below else np.nextafter(axis.lower, -np.inf)
        for bad in (at_lower, above, -7.0, np.nan, np.inf, -np.inf):
            arguments = list(INSIDE[name])
            arguments[index] = float(bad)
            value, error = evaluator(name, leg)(*arguments)
            # Skip subnormal numbers: XLA flushes them to zero, which may be in the domain.
            if not 0 < abs(bad) <= np.finfo(float).tiny:
                assert np.isnan(value), (axis.name, bad, value)
                assert np.isnan(error), (axis.name, bad, error)


@pytest.mark.parametrize(("name", "leg"), LEGS)
def test_every_leg_is_finite_at_the_ends_of_the_domain(name, leg):
    reference = REFERENCES[name]
    for index, axis in enumerate(reference.axes):
        ends = [axis.lower + 1e-3 if axis.open_below else axis.lower, min(axis.upper, 1e300)]
        for end in ends:
            arguments = list(INSIDE[name])
            arguments[index] = end
            value, error = evaluator(name, leg)(*arguments)
            assert np.isfinite(value), (axis.name, end)
            assert np.isfinite(error), (axis.name, end)


@pytest.mark.parametrize(("name", "leg"), LEGS)
def test_wrong_number_of_arguments_is_refused(name, leg):
    names = ", ".join(axis.name for axis in REFERENCES[name].axes)
    for arguments in (INSIDE[name][:-1], (*INSIDE[name], 0.5)):
        with pytest.raises(ValueError, match=f"{len(arguments)} arguments.*{names}"):
            REFERENCES[name].legs[leg](*arguments)


@pytest.mark.parametrize(("name", "leg"), LEGS)
def test_float32_is_refused(name, leg):
    with jax.enable_x64(False), pytest.raises(RuntimeError, match="need float64"):
        REFERENCES[name].legs[leg](*INSIDE[name])


def test_float64_is_accepted():
    require_float64()
    assert PS.value(*INSIDE["ps"]).dtype == jnp.float64


@pytest.mark.parametrize("name", ["ps", "g", "q"])
def test_legs_take_integers_and_work_under_vmap(name):
    reference, one = REFERENCES[name], [1] * len(REFERENCES[name].axes)
    points = jnp.array([one, INSIDE[name]], float).T
    batch = jax.jit(jax.vmap(reference.closed_form))(*points)
    assert batch.value.dtype == jnp.float64
    alone = [evaluator(name, "closed_form")(*map(float, point)).value for point in points.T]
    # XLA may fuse the operations of a batch in another way, which changes roundings only.
    np.testing.assert_allclose(batch.value, alone, rtol=1e-14)
    np.testing.assert_allclose(evaluator(name, "closed_form")(*one).value, alone[0], rtol=1e-14)


def test_best_leg_is_the_most_exact_one():
    assert {name: reference.best_leg for name, reference in REFERENCES.items()} == {
        "ps": "closed_form",
        "g": "closed_form",
        "q": "closed_form",
        "r": "quadrature",
        "velvet": "closed_form",
        "ggx-directional-albedo": "quadrature",
        "ggx-scale": "quadrature",
        "ggx-bias": "quadrature",
        "ggx-average-albedo": "quadrature",
        "sggx-filter": "quadrature",
        "sggx-filter-axes": "quadrature",
        **dict.fromkeys([*SKIN, *LOBES], "quadrature"),
        **dict.fromkeys(BANDS, "closed_form"),
    }
    assert REFERENCES["q"].value(0.5) == REFERENCES["q"].closed_form(0.5).value


def test_missing_leg_is_none():
    assert REFERENCES["r"].closed_form is None
    assert list(REFERENCES["r"].legs) == ["quadrature", "monte_carlo"]


HALF_OPEN = Axis("alpha", 0.0, 1.0, "α", open_below=True)
UNBOUNDED = Axis("density", 0.0, np.inf, "d")


def test_domain_is_written_as_an_interval():
    assert HALF_OPEN.domain == "(0, 1]"
    assert UNBOUNDED.domain == "[0, ∞)"
    assert Axis("theta", 0.0, RIGHT, "θ", "rad", "").domain == "[0, 1.5708]"


@pytest.mark.parametrize(
    ("axis", "inside", "outside"),
    [
        (HALF_OPEN, [1e-300, 0.5, 1.0], [0.0, -0.5, np.nextafter(1, 2), np.nan, np.inf]),
        (UNBOUNDED, [0.0, 1.0, 1e308], [-1e-300, np.nan, np.inf, -np.inf]),
    ],
)
def test_axis_checks_its_domain(axis, inside, outside):
    assert axis.contains(np.array(inside)).all()
    assert not axis.contains(np.array(outside)).any()
    for value in inside:
        assert axis.check(value) == value
    for value in outside:
        with pytest.raises(ValueError, match=rf"{axis.name} = .* outside its domain [(\[]0, "):
            axis.check(value)


def test_error_for_an_angle_names_the_unit():
    with pytest.raises(ValueError, match=r"theta_f = 45 rad is .* \[0, 1\.5708\] rad$"):
        REFERENCES["r"].axes[1].check(45.0)


def test_axes_make_a_box():
    np.testing.assert_array_equal(box_of(PS.axes[:2]), [(0, 1), (0, RIGHT)])


ENDS = [(0.001, 0.5), (0.05, 1.0), (0.1, 0.7), (1 / 3, 1e5), (3e-7, RIGHT)]


@pytest.mark.parametrize("scale", ["linear", "logarithmic", "square"])
@pytest.mark.parametrize(("lower", "upper"), ENDS)
def test_place_maps_fractions_to_the_domain_with_exact_ends(scale, lower, upper):
    axis = Axis("x", lower, upper, scale=scale)
    ends = axis.place(np.array([0.0, 1.0]))
    np.testing.assert_array_equal(ends, [lower, upper])
    near = axis.place(np.array([0.0, 5e-324, 1e-16, 0.5, np.nextafter(1, 0), 1.0]))
    assert axis.contains(near).all()
    assert np.all(np.diff(near) >= 0)
    many = np.random.default_rng(0).random((2, 3))
    assert axis.place(many).shape == (2, 3)


def test_place_follows_the_scale():
    fractions = np.array([0.25, 0.5, 0.75])
    axis = functools.partial(Axis, "x", 0.01, 100.0)
    np.testing.assert_allclose(axis().place(fractions), [25.0075, 50.005, 75.0025], rtol=1e-15)
    logarithmic = axis(scale="logarithmic").place(fractions)
    np.testing.assert_allclose(logarithmic, [0.1, 1.0, 10.0], rtol=1e-14)
    square = axis(scale="square").place(fractions)
    np.testing.assert_allclose(square, 0.01 + 99.99 * fractions**2, rtol=1e-15)


def test_angles_that_go_all_the_way_round_have_a_period():
    periods = {
        axis.name: axis.period for each in REFERENCES.values() for axis in each.axes if axis.period
    }
    assert periods == {"phi": 2 * np.pi}
    theta_f, theta_u, phi = 0.6, 0.7, 0.8
    moved = [PS.value(0.5, theta_f, theta_u, phi + turn) for turn in (0.0, -2 * np.pi)]
    np.testing.assert_allclose(moved[0], moved[1], rtol=1e-14)


def test_aliases_are_short_names_of_axes():
    aliases = {
        (name, axis.name): axis.alias for name, each in REFERENCES.items() for axis in each.axes
    }
    assert {key: alias for key, alias in aliases.items() if alias} == {
        ("g", "density"): "d",
        ("g", "cos_v"): "nu",
        ("q", "density"): "d",
        ("velvet", "asymmetry"): "k",
    }
    for each in REFERENCES.values():
        names = [name for axis in each.axes for name in (axis.name, axis.alias) if name]
        assert len(set(names)) == len(names)


LINE = Axis("x", 0.0, 1.0)


def doubling(batch: int) -> tuple[Reference, list[int]]:
    """Return a reference with the value 2x and the error `power`, and a log of what it traces."""
    traced = []

    @leg(LINE)
    def closed_form(x, *, power: int = 0) -> Estimate:
        traced.append(power)
        return Estimate(2 * x, jnp.full((), float(power)))

    reference = Reference(
        name="twice",
        symbol="2x",
        meaning="",
        definition="2x",
        axes=(LINE,),
        sampling=Sampling(fitted=3, checked=3, judged=3),
        closed_form=closed_form,
        batch=batch,
        options_at=lambda points: {"power": int(np.max(points) > 0.5)},
    )
    return reference, traced


@pytest.mark.parametrize("count", [1, 3, 4, 5, 8, 11])
def test_values_are_evaluated_in_batches_of_one_size(count):
    reference, traced = doubling(batch=4)
    points = np.linspace(0.1, 1, count)[:, None]
    estimates = reference.estimates(points)
    assert estimates.value.shape == estimates.error.shape == (count,)
    np.testing.assert_array_equal(estimates.value, 2 * points[:, 0])
    np.testing.assert_array_equal(reference.values(points), 2 * points[:, 0])
    assert isinstance(reference.values(points), np.ndarray)
    # One compilation serves all batches, also the last one, which is filled up.
    assert len(traced) == 1


def test_values_are_nan_outside_the_domain():
    reference, _ = doubling(batch=4)
    points = np.array([-0.1, 0.0, 0.5, 1.0, 1.1, np.nan])[:, None]
    np.testing.assert_array_equal(reference.values(points), [np.nan, 0, 1, 2, np.nan, np.nan])
    assert list(np.isnan(reference.estimates(points).error)) == [True, *[False] * 3, True, True]


def test_options_depend_on_the_points():
    reference, traced = doubling(batch=4)
    for upper, power in ((0.4, 0), (0.9, 1), (0.3, 0)):
        estimates = reference.estimates(np.linspace(0, upper, 6)[:, None])
        np.testing.assert_array_equal(estimates.error, power)
    assert traced == [0, 1]


NAMES = [pytest.param(n, marks=pytest.mark.slow) if n in SLOW else n for n in REFERENCES]


@pytest.mark.parametrize("name", NAMES)
def test_values_are_those_of_the_best_leg(name):
    reference, inside = REFERENCES[name], np.array(INSIDE[name])
    points = inside * np.linspace(0.9, 1.1, 3)[:, None]
    best = reference.legs[reference.best_leg]
    options = reference.options_at(points)
    expected = [float(best(*point, **options).value) for point in points]
    np.testing.assert_allclose(reference.values(points), expected, rtol=1e-14)


def test_axes_are_restricted_by_name():
    alpha, theta_f = restricted(R.axes, alpha=(0.15, 1.0))
    assert (alpha.lower, alpha.upper, alpha.open_below) == (0.15, 1.0, False)
    assert theta_f is R.axes[1]
    # The open end stays open where it is kept.
    assert restricted(R.axes, alpha=(0.0, 0.5))[0].open_below
    with pytest.raises(ValueError, match="'density' is no axis: allowed are alpha, theta_f"):
        restricted(R.axes, density=(0.0, 1.0))
    for domain in ((-0.1, 1.0), (0.5, 0.5), (0.5, 1.1)):
        with pytest.raises(ValueError, match=r"allowed is part of \(0, 1\]"):
            restricted(R.axes, alpha=domain)


# With fewer optimisations three of these values have another last digit, and then fits of the
# largest error of P_s end elsewhere. Tests compile with fewer, so this is a process of its own.
FULLY_COMPILED = """
import jax, numpy
jax.config.update("jax_enable_x64", True)
from integrals import PS
from integrals.reference import box_of
lower, upper = box_of(PS.axes).T
points = numpy.random.default_rng(1).uniform(lower, upper, (PS.batch, len(PS.axes)))
expected = jax.jit(jax.vmap(lambda x: PS.closed_form(*x)))(points).value
print(numpy.sum(PS.values(points) != numpy.asarray(expected)))
"""


@pytest.mark.slow
def test_exact_values_are_compiled_with_all_optimisations():
    command = [sys.executable, "-c", FULLY_COMPILED]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert done.stdout == "0\n"
