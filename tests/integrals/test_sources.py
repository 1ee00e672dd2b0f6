"""Sources: exact values within the stated errors, derivatives, batches, and errors for the user."""

import functools

import jax
import jax.numpy as jnp
import mpmath as mp
import numpy as np
import pytest

from integrals import (
    Axis,
    Estimate,
    Reference,
    Sampling,
    Source,
    closed_form,
    hemisphere,
    make_reference,
    quadrature,
    sphere,
)
from integrals.rules.directions import cosine_weighted, hemisphere_angles
from integrals.rules.interval import gauss_legendre
from integrals.sources import monte_carlo
from tests.integrals.exact_integrals import INTEGRALS, PLACE, PLANE

STANDARD_ERRORS = 5
# The exact values are themselves rounded.
ROUNDING = 4 * np.finfo(float).eps


def axis(name, lower, upper):
    return Axis(name=name, symbol=name, unit="1", lower=lower, upper=upper, meaning=name)


ETA = axis("eta", 1.0, 3.0)
K = axis("k", 0.1, 5.0)


def single(source, *axes):
    return make_reference(source, name="test", axes=axes)


def places(count, seed=3):
    """Return places in (0, 1): anywhere, and so close to ends of panels that nodes miss them."""
    rng = np.random.default_rng(seed)
    ends = rng.integers(0, 9, count // 2) / 8 + rng.normal(size=count // 2) * 10 ** rng.uniform(
        -6, -3, count // 2
    )
    some = np.concatenate([rng.uniform(0.02, 0.98, count - count // 2), ends])
    return some[(some > 0.005) & (some < 0.995)][:, None]


def assert_honest(reference, points, known):
    value, error = map(np.asarray, reference.estimates(points))
    exact = known.exact(points[:, 0])
    assert np.all(np.isfinite(value))
    assert np.all(np.abs(value - exact) <= error + ROUNDING * np.abs(exact))
    assert np.max(error) <= known.largest_error


# In the default run, the table without the integrands that resemble others.
ALIKE = (
    "layer at the end",
    "cos 6000t",
    "end kink",
    "1/√(1 − t)",
    "t^−0.9",
    "peak",
    "peak and 1/√t",
    "two jumps",
)


def some_slow(names, alike):
    return [pytest.param(n, marks=pytest.mark.slow if n in alike else ()) for n in names]


@pytest.mark.parametrize("name", some_slow(INTEGRALS, ALIKE))
def test_the_error_is_never_understated(name):
    known = INTEGRALS[name]
    assert_honest(single(quadrature(known.integrand, [(0, 1)]), PLACE), places(400), known)


def honest_with(name, effort):
    known = INTEGRALS[name]._replace(largest_error=np.inf)
    assert_honest(single(quadrature(known.integrand, [(0, 1)], **effort), PLACE), places(60), known)


# Without steps, a peak that one node sees is taken for a small one, and a singularity close to 1/t
# for a weaker one.
WITHOUT_STEPS = [name for name in INTEGRALS if "peak" not in name and name != "t^−0.99"]


@pytest.mark.slow
@pytest.mark.parametrize("name", WITHOUT_STEPS)
def test_the_error_is_honest_without_steps(name):
    honest_with(name, {"steps": 0})


@pytest.mark.slow
@pytest.mark.parametrize("effort", [{"steps": 6}, {"nodes": 6, "steps": 24}, {"nodes": 40}])
@pytest.mark.parametrize("name", WITHOUT_STEPS)
def test_the_error_is_honest_with_other_effort(name, effort):
    honest_with(name, effort)


@pytest.mark.parametrize(
    "name", some_slow(PLANE, ("smooth", "disc", "kink along an axis", "singular corner"))
)
def test_the_error_in_two_variables_is_never_understated(name):
    known = PLANE[name]
    points = places(16)
    assert_honest(single(quadrature(known.integrand, [(0, 1), (0, 1)]), PLACE), points, known)


@pytest.mark.slow
@pytest.mark.parametrize("variables", some_slow([3, 4], [4]))
def test_three_and_four_variables(variables):
    def integrand(*values):
        *t, a = values
        return jnp.exp(-a * sum(t))

    reference = single(quadrature(integrand, [(0, 1)] * variables), PLACE)
    a = np.array([0.3, 0.9])
    value, error = reference.estimates(a[:, None])
    np.testing.assert_allclose(value, (-np.expm1(-a) / a) ** variables, rtol=1e-10)
    assert np.all(error < 1e-3)


def reflectance(mu, eta):
    g = jnp.sqrt(eta * eta - (1 - mu) * (1 + mu))
    s = (g - mu) / (g + mu)
    p = (mu * (g + mu) - 1) / (mu * (g - mu) + 1)
    return s * s * (1 + p * p) / 2


def exact_fresnel_average(eta):
    def f(mu):
        g = mp.sqrt(eta * eta - 1 + mu * mu)
        s, p = (g - mu) / (g + mu), (mu * (g + mu) - 1) / (mu * (g - mu) + 1)
        return 2 * mu * s * s * (1 + p * p) / 2

    return mp.quad(f, [0, mp.sqrt(eta * eta - 1), 1] if eta < 1.4 else [0, 1])


@pytest.mark.slow
def test_the_average_of_a_dielectric_fresnel_reflectance():
    source = quadrature(lambda t, eta: 4 * t**3 * reflectance(t * t, eta), over=[(0, 1)])
    eta = np.array([1.0, 1 + 1e-6, 1.001, 1.01, 1.1, 1.33, 1.5, 1.8, 2.4, 3.0])
    value, error = map(np.asarray, single(source, ETA).estimates(eta[:, None]))
    exact = np.array([float(exact_fresnel_average(mp.mpf(float(x)))) for x in eta])
    assert exact[0] == 0
    assert np.all(np.abs(value - exact) <= error + 1e-15)
    assert np.all(error < 1e-12)


def ggx(light, mu, alpha):
    """The BRDF of GGX with height-correlated shadowing and F = 1, times the cosine of the light."""
    view = jnp.stack([jnp.sqrt((1 - mu) * (1 + mu)), 0.0 * mu, mu])
    half = light + view
    cosine = half[2] / jnp.linalg.norm(half)
    a2 = alpha**2
    density = a2 / (jnp.pi * (cosine**2 * (a2 - 1) + 1) ** 2)

    def root(c):
        return jnp.sqrt(a2 + (1 - a2) * c * c)

    return density * light[2] / (2 * (light[2] * root(mu) + mu * root(light[2])))


GGX_AXES = (axis("mu", 0.02, 1.0), axis("alpha", 0.05, 1.0))


def albedo_by_half_vectors(mu, alpha):
    """Integrate over half vectors, slope = α tan θ, with a fixed rule that ends at the horizon."""
    x, w = gauss_legendre(600, 0.0, 1.0)
    phi, w_phi = gauss_legendre(600, 0.0, np.pi)
    # cos²θ of the half vector: u = 1/(1 + tan²θ/α²) is uniform for the density D cos θ. The light
    # is above the horizon where 2 (v·h) h_z > μ: end the range of u there.
    sine = np.sqrt(1 - mu * mu)

    def light(u, phi):
        tangent2 = alpha**2 * (1 - u) / u
        hz = 1 / np.sqrt(1 + tangent2)
        hx = np.sqrt(tangent2) * hz * np.cos(phi)
        vh = sine * hx + mu * hz
        return vh, hz, 2 * vh * hz - mu

    low, high = np.zeros_like(phi), np.ones_like(phi)
    for _ in range(60):
        middle = (low + high) / 2
        above = light(middle, phi)[2] > 0
        low, high = np.where(above, low, middle), np.where(above, middle, high)
    u = high + (1 - high) * x[:, None] ** 2
    vh, hz, lz = light(u, phi)
    a2 = alpha**2

    def root(c):
        return np.sqrt(a2 + (1 - a2) * c * c)

    # f cos θ dω = G2 (v·h) / (μ h_z) · D h_z dω_h, and D h_z dω_h = du dφ / 2π.
    shadowing = 2 * mu * lz / (lz * root(mu) + mu * root(lz))
    values = np.where(lz > 0, shadowing * vh / (mu * hz), 0.0)
    return 2 * np.sum(w[:, None] * 2 * x[:, None] * (1 - high) * w_phi * values) / (2 * np.pi)


@functools.cache
def albedo():
    source = hemisphere(ggx) + monte_carlo(
        ggx, importance=cosine_weighted, dimensions=2, sequence="sobol"
    )
    return make_reference(source, name="albedo", axes=GGX_AXES)


@pytest.mark.slow
@pytest.mark.parametrize("mu", [0.1, 0.5, 1.0])
def test_the_albedo_of_a_smooth_surface(mu):
    points = np.array([[mu, 0.1]])
    value, error = albedo().estimates(points)
    np.testing.assert_allclose(value, albedo_by_half_vectors(mu, 0.1), atol=2e-6)
    assert abs(value[0] - albedo_by_half_vectors(mu, 0.1)) <= error[0] + 2e-6
    assert error[0] < 1e-6
    drawn = albedo().legs["monte_carlo"](*points[0])
    assert abs(drawn.value - value[0]) <= STANDARD_ERRORS * drawn.error


@pytest.mark.slow
def test_hemisphere_and_sphere_integrate_a_tilted_lobe():
    """The integral of |ω·t| is π over any hemisphere, for even integrands, and 2π on the sphere."""

    def lobe(direction, angle):
        return jnp.abs(direction[0] * jnp.sin(angle) + direction[2] * jnp.cos(angle))

    tilt = axis("angle", 0.0, 1.5)
    for source, exact in ((hemisphere(lobe), np.pi), (sphere(lobe), 2 * np.pi)):
        value, error = single(source, tilt).estimates(np.array([[0.0], [0.4]]))
        assert np.all(np.abs(value - exact) <= error)
        assert np.all(error < 1e-2)
        assert error[0] < 1e-11


@pytest.mark.slow
def test_breaks_at_the_horizon_of_a_map():
    """With the sphere's coordinates for a clamped cosine, a break makes the rule exact."""

    def clamped(direction, k):
        return jnp.maximum(direction[2], 0) ** k

    value, error = single(sphere(clamped), axis("k", 1.0, 3.0)).estimates(np.array([[1.0], [2.0]]))
    assert np.all(np.abs(value - 2 * np.pi / np.array([2, 3])) <= error)
    assert np.all(error < 1e-9)


@pytest.mark.slow
def test_importance_of_the_users_own():
    def near_pole(x, y, k):
        """Directions with the density ∝ e^(k cos θ), k in the axis."""
        cosine = 1 + jnp.log(x + (1 - x) * jnp.exp(-2 * k)) / k
        sine = jnp.sqrt((1 - cosine) * (1 + cosine))
        phi = 2 * jnp.pi * y
        direction = jnp.stack([sine * jnp.cos(phi), sine * jnp.sin(phi), cosine])
        return direction, 2 * jnp.pi * -jnp.expm1(-2 * k) / k * jnp.exp(k * (1 - cosine))

    lobe = sphere(lambda w, k: jnp.exp(k * (w[2] - 1)), importance=near_pole)
    k = np.array([0.5, 4.0])
    value, error = single(lobe, K).estimates(k[:, None])
    np.testing.assert_allclose(value, 2 * np.pi * -np.expm1(-2 * k) / k, rtol=1e-13)
    assert np.all(error < 1e-11)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("over", "integrand", "exact"),
    [
        pytest.param(
            (0, np.inf), lambda t, k: jnp.exp(-k * t), lambda k: 1 / k, marks=pytest.mark.slow
        ),
        ((lambda k: k, np.inf), lambda t, k: 1 / t**2, lambda k: 1 / k),
        pytest.param(
            (-np.inf, 0), lambda t, k: jnp.exp(k * t), lambda k: 1 / k, marks=pytest.mark.slow
        ),
        pytest.param(
            (-np.inf, np.inf),
            lambda t, k: jnp.exp(-k * t * t),
            lambda k: np.sqrt(np.pi / k),
            marks=pytest.mark.slow,
        ),
        ((-np.inf, np.inf), lambda t, k: 1 / (t * t + k * k), lambda k: np.pi / k),
        ((0, lambda k: k), lambda t, k: t * k, lambda k: k**3 / 2),
    ],
)
def test_infinite_ranges_and_ends_that_depend_on_axes(over, integrand, exact):
    reference = single(quadrature(integrand, [over]), K)
    k = np.array([0.2, 1.0, 4.5])
    value, error = reference.estimates(k[:, None])
    assert np.all(np.abs(value - exact(k)) <= error)
    assert np.all(error < 1e-9)
    if callable(over[0]) or callable(over[1]):
        slope = jax.jit(jax.vmap(jax.grad(reference.value)))(k)
        np.testing.assert_allclose(slope, (exact(k + 1e-5) - exact(k - 1e-5)) / 2e-5, rtol=1e-7)


@pytest.mark.slow
def test_a_break_that_moves_gives_the_derivative_of_a_jump():
    jump = quadrature(
        lambda t, a: jnp.where(t < a, 2.0, t), [(0, 1)], breaks=(lambda a: a, 0.25, 7.0)
    )
    reference = single(jump, PLACE)
    a = np.array([0.1, 0.25, 0.6])
    value, error = reference.estimates(a[:, None])
    np.testing.assert_allclose(value, 2 * a + (1 - a * a) / 2, rtol=1e-14)
    assert np.all(error < 1e-12)
    at = np.array([0.1, 0.6])
    np.testing.assert_allclose(jax.vmap(jax.grad(reference.value))(at), 2 - at, rtol=1e-13)


@pytest.mark.slow
@pytest.mark.parametrize(
    "over", some_slow([(-np.inf, np.inf), (0, np.inf), (-np.inf, 3)], [(0, np.inf), (-np.inf, 3)])
)
def test_breaks_in_infinite_ranges(over):
    reference = single(
        quadrature(lambda t, k: jnp.exp(-k * jnp.abs(t - 1)), [over], breaks=(1.0,)), K
    )
    k = np.array([0.5, 3.0])
    left = 0.0 if over[0] < 0 else np.exp(-k)
    right = np.exp(-2 * k) if over[1] < np.inf else 0.0
    value, error = reference.estimates(k[:, None])
    assert np.all(np.abs(value - (2 - left - right) / k) <= error)
    assert np.all(error < 1e-11)


@pytest.mark.parametrize("name", some_slow(["smooth", "peak on a plateau"], ["peak on a plateau"]))
@pytest.mark.slow
def test_derivatives_equal_finite_differences(name):
    known = INTEGRALS[name]
    value = single(quadrature(known.integrand, [(0, 1)]), PLACE).value
    a = np.array([0.001, 0.3, 0.77])
    step = 1e-5
    expected = (known.exact(a + step) - known.exact(a - step)) / (2 * step)
    slopes = [jax.jit(jax.vmap(by(value)))(a) for by in (jax.grad, jax.jacfwd)]
    np.testing.assert_allclose(slopes, [expected] * 2, rtol=1e-4, atol=1e-9)
    if name != "smooth":
        return
    second = jax.jacfwd(jax.grad(value))(0.5)
    steps = (known.exact(0.5 + 1e-4) - 2 * known.exact(0.5) + known.exact(0.5 - 1e-4)) / 1e-8
    np.testing.assert_allclose(second, steps, rtol=1e-4, atol=1e-6)


@pytest.mark.slow
def test_derivatives_of_an_integral_over_directions():
    value = albedo().value
    slope = jax.jit(jax.grad(value, argnums=(0, 1)))(0.5, 0.4)
    for index, step in enumerate(np.eye(2) * 1e-4):
        above, below = np.array([0.5, 0.4]) + step, np.array([0.5, 0.4]) - step
        difference = (value(*above) - value(*below)) / 2e-4
        np.testing.assert_allclose(slope[index], difference, atol=1e-6)


@pytest.mark.slow
def test_jit_and_vmap_agree_with_single_points():
    leg = single(quadrature(INTEGRALS["kink"].integrand, [(0, 1)]), PLACE).legs["quadrature"]
    a = np.array([0.2, 0.7])
    together = jax.jit(jax.vmap(leg))(a)
    for index, each in enumerate(a):
        alone = leg(each)
        assert isinstance(alone, Estimate)
        np.testing.assert_allclose(together.value[index], alone.value, rtol=1e-14)
        np.testing.assert_allclose(together.error[index], alone.error, atol=1e-13)


@pytest.mark.parametrize("count", [pytest.param(3, marks=pytest.mark.slow), 100])
def test_each_place_of_a_batch_takes_the_steps_that_it_needs(count):
    """At a = 0 the integrand has a singularity, and elsewhere none: the places differ in steps."""
    leg = quadrature(lambda t, a: jnp.sqrt(t + a), [(0, 1)]).legs([PLACE])["quadrature"]
    a = np.random.default_rng(3).permutation(np.append(np.geomspace(1e-6, 1, count), [0, 0]))
    together = jax.vmap(leg)(a)
    exact = 2 / 3 * ((1 + a) ** 1.5 - a**1.5)
    np.testing.assert_allclose(together.value, exact, rtol=1e-12)
    assert (np.abs(together.value - exact) <= together.error).all()
    alone = Estimate(*np.transpose([leg(each) for each in a]))
    np.testing.assert_allclose(together.value, alone.value, rtol=1e-15)
    np.testing.assert_allclose(together.error, alone.error, atol=1e-13)


def test_a_nan_in_the_integrand_is_not_hidden():
    """The probes miss the place, but the rule does not."""
    reference = single(quadrature(lambda t, a: jnp.sqrt(t - 0.001), [(0, 1)]), PLACE)
    assert np.isnan(reference.value(0.5))


def test_a_closed_form_states_its_rounding():
    legs = closed_form(jnp.sin).legs([PLACE])
    value, error = legs["closed_form"](0.5)
    assert value == np.sin(0.5)
    assert 0 < error < 1e-14
    assert closed_form(jnp.tanh, 1e-7).legs([PLACE])["closed_form"](0.5).error == 1e-7
    stated = closed_form(jnp.tanh, lambda a: a * 1e-3).legs([PLACE])["closed_form"]
    assert stated(0.5).error == 5e-4
    assert np.isnan(stated(1.5).value)


@pytest.mark.slow
def test_sources_join_to_independent_legs():
    smooth = INTEGRALS["smooth"]
    exact = closed_form(lambda a: jnp.where(a > 0, jnp.expm1(a) / jnp.where(a > 0, a, 1), 1))
    integral = quadrature(smooth.integrand, [(0, 1)])
    drawn = monte_carlo(smooth.integrand, sequence="sobol")
    for source in (drawn + integral + exact, (integral, exact, drawn)):
        reference = make_reference(
            source, name="test", axes=[PLACE], symbol="T", meaning="m", definition="d"
        )
        assert isinstance(reference, Reference)
        assert list(reference.legs) == ["closed_form", "quadrature", "monte_carlo"]
        a, b, c = (leg(0.4) for leg in reference.legs.values())
        assert abs(a.value - b.value) <= a.error + b.error
        assert abs(a.value - c.value) <= STANDARD_ERRORS * c.error
    assert isinstance(exact + integral, Source)
    with pytest.raises(ValueError, match="two sources have a leg quadrature"):
        integral + integral


@pytest.mark.parametrize("sequence", ["random", "sobol"])
def test_monte_carlo_from_a_density(sequence):
    """Exponential distances: the density is e^(−s)."""
    source = monte_carlo(
        lambda s, k: jnp.exp(-k * s),
        importance=lambda x, k: (-jnp.log1p(-x), 1 / (1 - x)),
        samples=1 << 13,
        sequence=sequence,
    )
    leg = source.legs([K])["monte_carlo"]
    value, error = leg(2.0)
    assert abs(value - 0.5) <= STANDARD_ERRORS * error
    assert 0 < error < 1e-2
    assert leg(2.0, seed=1).value != value
    assert leg(2.0, seed=0).value == value
    assert leg(2.0, samples=1 << 15).error < error


def test_default_sampling_depends_on_axes_and_cost():
    def of(source, *axes):
        return single(source, *axes).sampling

    assert of(closed_form(lambda a: a), PLACE).judged == 16
    assert of(closed_form(lambda a, k: a * k), PLACE, K).fitted == 13
    assert of(closed_form(lambda a, k, eta: a * k), PLACE, K, ETA).judged == 17
    assert not of(hemisphere(lambda w, a: w[2]), PLACE).climbs
    assert single(closed_form(lambda a: a), PLACE).batch == 8192
    chosen = Sampling(fitted=5, checked=6, judged=7)
    source = closed_form(lambda a: a)
    assert make_reference(source, name="t", axes=[PLACE], sampling=chosen).sampling is chosen


def test_an_interval_may_be_empty_on_a_face_of_the_domain():
    """∫₀ᵃ cos t dt = sin a, with a break that the interval need not contain."""
    source = quadrature(lambda t, a: jnp.cos(t), [(0, lambda a: a)], breaks=[lambda a: 1 - a])
    leg = single(source, axis("a", 0.0, 1.0)).quadrature
    for a in (0.0, 0.3, 1.0):
        assert leg(a).value == pytest.approx(np.sin(a), abs=1e-15)
    assert jax.grad(lambda a: leg(a).value)(0.0) == pytest.approx(1.0)


def named(t, a):
    return t * a


UNIT = [(0, 1)]


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (
            lambda: quadrature(named, UNIT).legs([PLACE, K]),
            r"test_sources.py:\d+: named\(t, a\) ca",
        ),
        (lambda: quadrature(named, [(0, 1), (0, 1)]).legs([PLACE]), "t1, t2 and then the axis a"),
        (lambda: closed_form(named).legs([PLACE]), r"cannot take 1 arguments: .* the axis a$"),
        (lambda: closed_form(named, named).legs([PLACE]), "cannot take 1 arguments"),
        (lambda: quadrature(named, [(1, 1)]), r"over \(1, 1\): the interval is empty"),
        (lambda: quadrature(named, [(np.inf, np.inf)]), "the interval is empty"),
        (lambda: quadrature(named, [(np.inf, lambda a: a)]), "the interval is empty"),
        (lambda: quadrature(named, [(float("nan"), 1)]), "the interval is empty"),
        (
            lambda: quadrature(named, [(lambda a: a, 0)]).legs([PLACE]),
            r"at a = .*: the interval is",
        ),
        (
            lambda: quadrature(named, [(lambda a: a, lambda a: a)]).legs([PLACE]),
            r"at a = .*: the interval is",
        ),
        (lambda: quadrature(named, [(lambda: 0, 1)]).legs([PLACE]), "cannot take 1 arguments"),
        (lambda: single(quadrature(named, UNIT)), r"axes = \[\]: at least one Axis is needed"),
        (lambda: quadrature(named, [0, 1]), "expected is .lower, upper. for each variable"),
        (lambda: quadrature(named, UNIT, breaks=[(), ()]), "one sequence for each of the 1 var"),
        (lambda: quadrature(named, UNIT, breaks=[np.nan]), "have to be finite"),
        (lambda: quadrature(named, UNIT * 5), "5 variables of integration: allowed are 1 to 4"),
        (lambda: quadrature(named, UNIT, nodes=3), "nodes = 3: allowed are 4 to 64"),
        (lambda: quadrature(named, UNIT, steps=-1), "steps = -1: allowed are 0 to"),
        (lambda: quadrature(named, UNIT, tolerance=0.0), "tolerance = 0.0: it has to be positive"),
        (
            lambda: quadrature(lambda t, a: jnp.sqrt(t - a), UNIT).legs([PLACE]),
            r"lambda\(t, a\) is NaN at t = 0\.\d+, a = [01]",
        ),
        (
            lambda: hemisphere(lambda w, a: jnp.log(w[0])).legs([PLACE]),
            r"lambda\(w, a\) is NaN at direction = \[",
        ),
        (lambda: hemisphere(lambda w, a: w).legs([PLACE]), r"returns \(3,\): expected is a scalar"),
        (
            lambda: hemisphere(lambda w, a: w[2], importance=lambda x, y, a: x).legs([PLACE]),
            "has to return a place and a Jacobian",
        ),
        (
            lambda: monte_carlo(lambda s, a: s, importance=lambda x, a: (x, jnp.log(x))).legs(
                [PLACE]
            ),
            "negative Jacobian at x1 =",
        ),
        (lambda: monte_carlo(named, samples=1), "samples = 1"),
        (lambda: monte_carlo(named, dimensions=0), "dimensions = 0"),
    ],
)
def test_errors_name_the_function_and_what_is_allowed(make, message):
    with pytest.raises(ValueError, match=message):
        make()


def test_an_error_of_the_users_function_is_their_own():
    def broken(t, a):
        raise KeyError("mine")

    with pytest.raises(KeyError, match="mine"):
        quadrature(broken, UNIT).legs([PLACE])


def test_maps_have_the_solid_angle_as_jacobian():
    x = np.linspace(0.1, 0.9, 5)
    for mapping in (hemisphere_angles, cosine_weighted):
        for u in x:
            direction = mapping(u, 0.3)[0]
            tangents = jax.jacfwd(lambda p, mapping=mapping: mapping(p[0], p[1])[0])(
                jnp.array([u, 0.3])
            )
            area = jnp.linalg.norm(jnp.cross(tangents[:, 0], tangents[:, 1]))
            np.testing.assert_allclose(mapping(u, 0.3)[1], area, rtol=1e-12)
            np.testing.assert_allclose(jnp.linalg.norm(direction), 1, rtol=1e-14)
