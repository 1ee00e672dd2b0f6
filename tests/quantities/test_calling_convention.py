"""How quantities are called in a shader: the supplement's functions, arguments and clamps."""

from dataclasses import replace

import numpy as np
import pytest

from coefficients.catalogue import resolve
from fitting.points.grids import sobol_points
from programs import evaluate, toolchain, trace, write_source
from quantities import problem
from quantities.calling_convention import renamed

EPS = float(np.finfo(np.float32).eps)
NAMES_IN_PRINT = {
    "ps": ["CalcFuzzPsCoeffs", "FuzzPs"],
    "g": ["FuzzGApprox"],
    "q": ["FuzzAveragePenetration"],
    "r": ["FuzzAveragePs"],
    "velvet": ["FuzzVelvetNorm"],
}
NAMES_OF_G = ("published/g", "g", *(f"best/g-{cost}" for cost in (9, 10, 13, 16, 17, 19)))
PUBLISHED = ("published/ps", "published/g", "published/q", "published/r")
# The longest sum of a listing: each of its terms is rounded in its powers, its product and the
# partial sums after it. Two orders of the same sum are each within this of the exact one.
LISTING_ROUNDINGS = 2 * 16


@pytest.mark.parametrize("name", [*NAMES_IN_PRINT, *PUBLISHED, "best/ps-40"])
def test_functions_have_the_names_in_print(name):
    entry = resolve(name)
    expected = NAMES_IN_PRINT[entry.problem.name]
    assert [each.name for each in entry.functions()] == expected


def in_c(function, rows):
    """Run a function's float32 C."""
    if toolchain("c").missing("float") is not None:
        pytest.skip("gcc is not here")
    return (
        toolchain("c").run(write_source(function, "c"), function, rows, "float").astype(np.float32)
    )


def listing_terms(alpha, theta_f):
    """Transcribe the powers of Listing 2: b, g, d, …, in float32."""
    one = np.float32(1)
    b, g, d = one - alpha, np.cos(theta_f), np.sin(theta_f)
    b2, g2, d2 = b * b, g * g, d * d
    return b, np.stack(
        [b, g, d, b2, g2, b * g, b * d, b2 * b, g2 * g, d2 * d, b2 * g, b2 * d, b * g2]
    )


def listing_quotient(p, q, b, x, y):
    """Transcribe b · num / den with the sums in the listing's order, and bound their rounding."""
    num, num_size = p[0] + 0 * b, np.abs(p[0]) + 0 * b
    den, den_size = 1 + 0 * b, 1 + 0 * b
    for constant, term in zip(p[1:], x, strict=True):
        num, num_size = num + constant * term, num_size + np.abs(constant * term)
    for constant, term in zip(q, y, strict=True):
        den, den_size = den + constant * term, den_size + np.abs(constant * term)
    value = b * num / den
    bound = np.abs(b) * (num_size / np.abs(den) + np.abs(num) * den_size / den**2)
    return value, LISTING_ROUNDINGS * EPS * bound


def materials(count=4096):
    """Return α and θf in float32, inside, at the ends and beyond the domain."""
    rng = np.random.default_rng(5)
    alpha = np.concatenate([rng.uniform(-0.2, 1.2, count), [0.15, 1.0, 0.15, 1.0]])
    theta = np.concatenate([rng.uniform(-0.2, 1.8, count), [0.1, 0.1, 1.6, 1.6]])
    return alpha.astype(np.float32), theta.astype(np.float32)


def listing_clamp(alpha, theta_f, least_theta):
    """Transcribe the listings' clamps."""
    half_pi = np.float32(np.pi) * np.float32(0.5)
    theta_f = np.maximum(np.float32(least_theta), np.minimum(half_pi, theta_f))
    return np.maximum(np.float32(0.15), np.minimum(np.float32(1), alpha)), theta_f


def constants_of(name: str) -> np.ndarray:
    return np.array(resolve(name).require_table().coefficients, np.float32)


@pytest.mark.parametrize("name", ["published/ps", "published/ps@printed"])
def test_calc_fuzz_ps_coeffs_is_the_listing_with_rows_3_and_4_exchanged(name):
    constants = constants_of("published/ps@printed")
    alpha, theta_f = materials()
    b, x = listing_terms(*listing_clamp(alpha, theta_f, 0.1))
    calc, value = resolve(name).functions()
    given = in_c(calc, np.stack([alpha, theta_f], 1))
    corrected = name == "published/ps"
    rows = [0, 1, 2, 4, 3, 5] if corrected else range(6)
    for index, row in enumerate(rows):
        expected, bound = listing_quotient(constants[row, :14], constants[row, 14:], b, x, x)
        expected = np.float32(0.5 if row == 0 else 0) + expected
        assert (np.abs(given[:, index] - expected) <= bound + EPS * np.abs(expected)).all(), index
    # Eq. (1), as a plain sum, from the same coefficients.
    light = np.random.default_rng(6).uniform(0, 1, (len(given), 2)).astype(np.float32)
    n, t = light.T
    terms = given * np.stack([np.ones_like(n), n, t, n * n, n * t, t * t], 1)
    fraction = in_c(value, np.concatenate([given, light], 1))[:, 0]
    # The code clamps it to [0, 1], which the listing does not.
    expected = np.clip(terms.sum(1), 0, 1)
    assert (np.abs(fraction - expected) <= 8 * EPS * np.abs(terms).sum(1)).all()


def test_g_q_and_r_are_the_listings():
    rng = np.random.default_rng(7)
    density = rng.uniform(0.001, 0.8, 4096).astype(np.float32)
    nu = rng.uniform(0.001, 1, 4096).astype(np.float32)
    d = np.minimum(density, np.float32(0.5))

    c = constants_of("published/g")
    (approximation,) = resolve("published/g").functions()
    den = d + nu * (c[2] + nu * nu * c[3])
    expected = (d * (1 + nu * (c[0] + nu * c[1]))) / den
    # The same operations in the same order: only the compiler may differ.
    np.testing.assert_allclose(
        in_c(approximation, np.stack([nu, density], 1))[:, 0], expected, rtol=2 * EPS
    )
    c = constants_of("published/q")
    (average,) = resolve("published/q").functions()
    np.testing.assert_allclose(
        in_c(average, density[:, None])[:, 0], 1 + d * (c[0] + d * c[1]), rtol=2 * EPS
    )
    c = constants_of("published/r")
    (average,) = resolve("published/r").functions()
    alpha, theta_f = materials()
    b, x = listing_terms(*listing_clamp(alpha, theta_f, 0.0))
    expected, bound = listing_quotient(c[:14], c[14:], b, x, x[:3])
    given = in_c(average, np.stack([alpha, theta_f], 1))[:, 0]
    assert (np.abs(given - (np.float32(0.5) + expected)) <= bound + EPS).all()


@pytest.mark.parametrize(
    ("name", "outside", "inside"),
    [
        ("ps", [[-1.0, 0.5], [3.0, 0.5], [0.5, -2.0], [0.5, 9.0]],
               [[0.15, 0.5], [1.0, 0.5], [0.5, 0.1], [0.5, np.pi / 2]]),
        ("r", [[-1.0, 0.5], [3.0, 0.5], [0.5, -2.0], [0.5, 9.0]],
              [[0.15, 0.5], [1.0, 0.5], [0.5, 0.0], [0.5, np.pi / 2]]),
        ("g", [[0.3, 7.0], [0.3, -1.0], [-0.1, 0.2], [0.0, 0.2], [7.0, 0.2]],
              [[0.3, 0.5], [0.3, 0.0], [0.001, 0.2], [0.001, 0.2], [1.0, 0.2]]),
        ("q", [[7.0], [-0.1]], [[0.5], [0.0]]),
        ("velvet", [[-1.0], [0.5]], [[-0.95], [0.0]]),
    ],
)  # fmt: skip
def test_arguments_are_clamped_to_the_domain(name, outside, inside):
    program = trace(resolve(name).functions()[0])
    np.testing.assert_array_equal(
        evaluate(program, np.array(outside)), evaluate(program, np.array(inside))
    )


@pytest.mark.parametrize(
    ("name", "clamped"),
    [("ps", [1, 1]), ("best/ps-11", [1, 1]), ("g", [1, 1]), ("q", 1), ("r", [1, 1]), ("velvet", 1)],
)
def test_a_form_on_another_domain_is_clamped_to_its_own(name, clamped):
    entry = resolve(name)
    form, calling = entry.require_fitted().form, entry.problem.calling
    axes = tuple(replace(axis, upper=(axis.lower + axis.upper) / 2) for axis in form.axes)
    halved = replace(form, axes=axes).fitted(entry.require_fitted().coefficients)
    wide, narrow = (calling.functions(each)[0] for each in (entry.require_fitted(), halved))
    corner = np.array([[parameter.domain[1] for parameter in narrow.parameters]])
    assert (corner < [parameter.domain[1] for parameter in wide.parameters]).all()
    np.testing.assert_array_equal(
        evaluate(trace(narrow), corner + 0.01 * np.array(clamped)), evaluate(trace(wide), corner)
    )


@pytest.mark.parametrize("name", [*NAMES_OF_G, *(f"{each}@zero" for each in NAMES_OF_G)])
def test_a_layer_that_is_absent_scatters_nothing(name):
    """G(0, ν) = 0 for every ν, although the forms' domain begins at d = 0.001."""
    name, _, zero = name.partition("@")
    program = trace(resolve(name).functions()[0])
    nu = np.array([0.0, -0.0, -1.0]) if zero else np.linspace(0.001, 1, 65)
    assert (evaluate(program, np.stack([nu, 0 * nu], 1)) == 0).all()
    # Between 0 and the domain the values rise, and stay below that at the domain's end.
    density = np.linspace(0, 0.001, 65)
    for cosine in (0.001, 0.01, 1.0):
        values = evaluate(program, np.stack([np.full(65, cosine), density], 1))[:, 0]
        assert (np.diff(values) > 0).all()


def test_a_second_functions_cosines_are_clamped_and_so_is_its_value():
    calc, value = (trace(each) for each in resolve("best/ps-40").functions())
    material = evaluate(calc, np.array([[0.3, 0.7]]))[0]

    def at(*cosines):
        return evaluate(value, np.array([[*material, *cosines]]))[0, 0]

    assert at(-0.3, 0.2) == at(0.0, 0.2)
    assert at(1.5, 0.2) == at(1.0, 0.2)
    assert at(0.5, -7.0) == at(0.5, -1.0)
    assert at(0.5, 1e9) == at(0.5, 1.0)
    # No light is along n and −t if t is not horizontal.
    assert at(1.0, -1.0) == 0.0


def test_arguments_come_in_the_order_of_the_function_not_of_the_form():
    entry = resolve("g")
    points = sobol_points(entry.axes, 4, seed=1)
    (columns,) = entry.problem.calling.arguments_at(entry.require_fitted(), points)
    assert [parameter.name for parameter in entry.functions()[0].parameters] == ["NdotV", "density"]
    np.testing.assert_array_equal(columns, points[:, ::-1])


def test_the_second_function_of_p_s_takes_the_results_of_the_first_and_cosines():
    entry = resolve("ps")
    calc, value = entry.functions()
    assert (calc.result, calc.result_name) == (6, "c")
    assert [parameter.name for parameter in calc.parameters] == ["alpha", "thetaF"]
    assert [(p.name, p.size) for p in value.parameters] == [
        ("c", 6), ("NdotU", None), ("TdotU", None),
    ]  # fmt: skip
    points = sobol_points(entry.axes, 5, seed=2)
    material, light = entry.arguments_at(points)
    np.testing.assert_array_equal(material, points[:, :2])
    np.testing.assert_allclose(light[:, 0], np.cos(points[:, 2]), rtol=1e-15)
    # The domain of the results holds what the first function returns.
    results = evaluate(trace(calc), material)
    assert np.abs(results).max() <= 1.01 * value.parameters[0].domain[1]


def test_clamped_arguments_keep_their_name_in_exported_code():
    """A clamp is no assignment of the form's author: the convention names its result."""
    for name, local in (("ps", "theta_f"), ("r", "theta_f"), ("g", "density"), ("q", "density")):
        hints = {step.hint for step in trace(resolve(name).functions()[0]).steps}
        assert local in hints


def test_a_convention_without_clamps_adds_no_steps():
    entry = resolve("q")
    calling = entry.problem.calling
    bare = replace(calling, arguments=(replace(calling.arguments[0], clamp="none"),))
    (clamped,), (free,) = (each.functions(entry.require_fitted()) for each in (calling, bare))
    assert len(trace(clamped).steps) == len(trace(free).steps) + 2


@pytest.mark.parametrize(
    ("quantity", "said"), [("g", "G (Eq. 3)"), ("q", "Q (Eq. 4)"), ("r", "R (Eq. 5)")]
)
def test_the_summary_says_which_equation(quantity, said):
    (function,) = resolve(quantity).functions()
    assert said in function.summary


def test_the_summary_of_a_familys_form_says_nothing_of_internal_names():
    (function,) = resolve("best/g-9").functions()
    assert function.summary.startswith("G; clamps")


def test_functions_may_have_another_name():
    calc, value = resolve("ps").functions(name="Fibre")
    assert (calc.name, value.name) == ("CalcFibreCoeffs", "Fibre")
    assert "FuzzPs" not in calc.summary
    assert "Fibre" in calc.summary
    assert resolve("exact/ps").functions(name="Fibre")[0].name == "Fibre"
    assert (
        renamed(problem("q").calling.functions(resolve("q").require_fitted()), "F")[0].name == "F"
    )
    with pytest.raises(ValueError, match="function name '2x' is no identifier"):
        resolve("q").functions(name="2x")
