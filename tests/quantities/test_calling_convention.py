"""What is exported of each table: the paper's functions, in every language, with honest headers."""

import functools
import os
import re
from dataclasses import replace

import jax.numpy as jnp
import numpy as np
import pytest

from coefficients import verify
from coefficients.catalogue import form_of, load
from coefficients.shaders import EXACT_PS, exact_ps, functions_of, shader
from coefficients.signatures import signature
from fitting import form_values
from programs.function import Parameter, function
from programs.languages import TARGETS
from programs.printing.printer import write
from programs.program import evaluate
from programs.toolchains.registry import toolchain
from programs.toolchains.toolchain import Toolchain
from programs.tracing.tracer import trace
from shadefit import export

TABLES = [
    "ps",
    "g",
    "q",
    "r",
    "velvet",
    "published/ps",
    "published/g",
    "published/q",
    "published/r",
]
EPS = float(np.finfo(np.float32).eps)
PAPER_NAMES = {
    "ps": ["CalcFuzzPsCoeffs", "FuzzPs"],
    "g": ["FuzzGApprox"],
    "q": ["FuzzAveragePenetration"],
    "r": ["FuzzAveragePs"],
    "velvet": ["FuzzVelvetNorm"],
}
# The longest sum of a listing: each of its terms is rounded in its powers, its product and the
# partial sums after it. Two orders of the same sum are each within this of the exact one.
LISTING_ROUNDINGS = 2 * 16


@pytest.mark.parametrize("name", TABLES)
def test_the_code_that_is_exported_is_the_form_that_was_fitted(name):
    problem = verify.Problem(shader(name, "double"), "double", exponent=12)
    expected = form_values(form_of(load(name)), problem.points)
    # Both are float64; the forms' quotients lose up to three digits.
    np.testing.assert_allclose(problem.form, expected, rtol=0, atol=1e-12)


@pytest.mark.parametrize("name", TABLES)
def test_functions_have_the_papers_names(name):
    assert [each.name for each in functions_of(load(name))] == PAPER_NAMES[
        name.removeprefix("published/")
    ]


def in_c(function, rows):
    """Run a function's float32 C."""
    if toolchain("c").missing("float") is not None:
        pytest.skip("gcc is not here")
    return toolchain("c").run(write(function, "c"), function, rows, "float").astype(np.float32)


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
    """Give α and θf in float32, inside, at the ends and beyond the domain."""
    rng = np.random.default_rng(5)
    alpha = np.concatenate([rng.uniform(-0.2, 1.2, count), [0.15, 1.0, 0.15, 1.0]])
    theta = np.concatenate([rng.uniform(-0.2, 1.8, count), [0.1, 0.1, 1.6, 1.6]])
    return alpha.astype(np.float32), theta.astype(np.float32)


def listing_clamp(alpha, theta_f, least_theta):
    """Transcribe the listings' clamps."""
    half_pi = np.float32(np.pi) * np.float32(0.5)
    theta_f = np.maximum(np.float32(least_theta), np.minimum(half_pi, theta_f))
    return np.maximum(np.float32(0.15), np.minimum(np.float32(1), alpha)), theta_f


@pytest.mark.parametrize("name", ["published/ps", "published/ps@printed"])
def test_calc_fuzz_ps_coeffs_is_the_listing_with_rows_3_and_4_exchanged(name):
    constants = np.array(load("published/ps@printed").coefficients, np.float32)
    alpha, theta_f = materials()
    b, x = listing_terms(*listing_clamp(alpha, theta_f, 0.1))
    calc, value = functions_of(load(name))
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
    assert (np.abs(fraction - terms.sum(1)) <= 8 * EPS * np.abs(terms).sum(1)).all()


def test_g_q_and_r_are_the_listings():
    rng = np.random.default_rng(7)
    density = rng.uniform(0.001, 0.8, 4096).astype(np.float32)
    nu = rng.uniform(0.001, 1, 4096).astype(np.float32)
    d = np.minimum(density, np.float32(0.5))

    c = np.array(load("published/g").coefficients, np.float32)
    (approximation,) = functions_of(load("published/g"))
    den = d + nu * (c[2] + nu * nu * c[3])
    expected = (d * (1 + nu * (c[0] + nu * c[1]))) / den
    # The same operations in the same order: only the compiler may differ.
    np.testing.assert_allclose(
        in_c(approximation, np.stack([nu, density], 1))[:, 0], expected, rtol=2 * EPS
    )
    c = np.array(load("published/q").coefficients, np.float32)
    (average,) = functions_of(load("published/q"))
    np.testing.assert_allclose(
        in_c(average, density[:, None])[:, 0], 1 + d * (c[0] + d * c[1]), rtol=2 * EPS
    )
    c = np.array(load("published/r").coefficients, np.float32)
    (average,) = functions_of(load("published/r"))
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
        ("g", [[0.3, 7.0]], [[0.3, 0.5]]),
        ("q", [[7.0]], [[0.5]]),
    ],
)  # fmt: skip
def test_arguments_are_clamped_as_the_listings_clamp_them(name, outside, inside):
    program = trace(functions_of(load(name))[0])
    np.testing.assert_array_equal(
        evaluate(program, np.array(outside)), evaluate(program, np.array(inside))
    )


@pytest.mark.parametrize(
    ("name", "clamped"),
    [("ps", [1, 1]), ("best/ps-11", [1, 1]), ("g", [0, 1]), ("q", 1), ("r", [1, 1]), ("velvet", 1)],
)
def test_a_form_on_another_domain_is_clamped_to_its_own(name, clamped):
    form = form_of(load(name))

    class Narrow(type(form)):
        axes = tuple(replace(a, upper=(a.lower + a.upper) / 2) for a in type(form).axes)

    wide, narrow = (signature(each)[0] for each in (form, Narrow(form.coefficients)))
    corner = np.array([[parameter.domain[1] for parameter in narrow.parameters]])
    assert (corner < [parameter.domain[1] for parameter in wide.parameters]).all()
    np.testing.assert_array_equal(
        evaluate(trace(narrow), corner + 0.01 * np.array(clamped)), evaluate(trace(wide), corner)
    )


def test_density_is_not_clamped_from_below():
    for name in ("g", "q"):
        program = trace(functions_of(load(name))[0])
        width = len(program.inputs)
        low = evaluate(program, np.full((1, width), -0.1))
        assert low[0, 0] != evaluate(program, np.array([[-0.1] * (width - 1) + [0.0]]))[0, 0]


def test_a_name_of_ones_own():
    calc, value = functions_of(load("ps"), "Fibre")
    assert (calc.name, value.name) == ("CalcFibreCoeffs", "Fibre")
    assert "FuzzPs" not in calc.summary
    assert exact_ps(name="Fibre")[0].name == "Fibre"
    assert shader("q", function_name="Fibre").functions[0].name == "Fibre"
    with pytest.raises(ValueError, match="function name '2x' is no identifier"):
        functions_of(load("q"), "2x")


@pytest.mark.parametrize("language", TARGETS)
def test_any_function_of_a_user_exports(language):
    def lobe(cosine, alpha):
        return jnp.exp(-alpha * cosine) / (1.0 + cosine)

    parameters = (Parameter("NdotU", (0.0, 1.0)), Parameter("alpha", (0.0, 4.0)))
    mine = function("Lobe", parameters, lobe)
    precision = verify.precision_of(language, None)
    source = write(mine, language, precision)
    assert "Lobe(" in source
    chain = toolchain(language)
    if chain.missing(precision) is None and language != "cuda":
        rows = np.random.default_rng(8).uniform(0, 1, (100, 2))
        expected = np.exp(-rows[:, 1] * rows[:, 0]) / (1 + rows[:, 0])
        given = chain.run(source, mine, rows, precision)[:, 0]
        # The device's exp is good to several units in the last place, Blender's to 1e-5.
        np.testing.assert_allclose(given, expected, rtol=2e-5)


@pytest.fixture
def few_points(monkeypatch):
    monkeypatch.setattr(export, "Problem", functools.partial(verify.Problem, exponent=8))


EVERY = [(key, kind) for key, spelled in TARGETS.items() for kind in spelled.types]


@pytest.mark.parametrize(("language", "precision"), EVERY)
def test_every_language_and_precision_has_an_honest_header(few_points, language, precision):
    # Q takes no function that a language may lack; nvcc takes seconds a run.
    source = export.code("q", language, precision)
    comment = TARGETS[language].comment
    head = source.partition("\n\n")[0].splitlines()
    assert all(line.startswith(comment) for line in head)
    assert max(map(len, head)) <= 100
    text = " ".join(line.removeprefix(comment).strip() for line in head)
    for label in ("Quantity", "Equation", "Domain", "Error in exact arithmetic", "Cost"):
        assert f"{label}: " in text
    assert f"Made by: shadefit export q --to {language} --precision {precision}" in text
    measured = re.search(rf"Error in {precision}: rms (\S+), largest (\S+) against", text)
    # As `shadefit compare` has it, within the few points that are used here.
    assert float(measured[1]) == pytest.approx(4.7e-3, rel=0.2)
    assert float(measured[2]) == pytest.approx(1.0e-2, rel=0.1)
    ran = toolchain(language).missing(precision) is None
    assert ("this code run in" in text) == ran
    assert ("emulated" in text) != ran
    assert ("Half precision: good enough" in text) == (precision == "half")
    assert source == source.encode("ascii").decode()


@pytest.mark.parametrize(
    ("name", "domain"),
    [
        ("q", "density in [0, 0.5]"),
        (
            EXACT_PS,
            "NdotU in [0, 1], TdotU in [-1, 1], NdotT in [0, 1], alpha in [0.05, 1]",
        ),
        (
            "published/ps",
            "alpha in [0.15, 1], thetaF in [0.1, 1.5708] rad, NdotU in [0, 1], TdotU in [-1, 1]",
        ),
    ],
)
def test_the_headers_domain_is_in_the_functions_arguments(name, domain):
    assert export._domain(shader(name).functions) == domain


def test_without_a_compiler_the_error_is_emulated(few_points, monkeypatch):
    monkeypatch.setattr(Toolchain, "missing", lambda self, precision: "not here")
    assert "emulated, every operation rounded: HLSL was not run" in " ".join(
        export.code("q", "hlsl").replace("//", "").split()
    )


def test_with_a_compiler_that_fails_the_error_is_emulated(few_points, monkeypatch, tmp_path):
    compiler = tmp_path / "gcc"
    compiler.write_text("#!/bin/sh\nexit 1\n")
    compiler.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path), prepend=os.pathsep)
    assert (
        "emulated, every operation rounded: "
        "C code of FuzzAveragePenetration in float does not compile (status 1))"
    ) in " ".join(export.code("q", "c").replace("//", "").split())


@pytest.mark.parametrize("name", ["g", EXACT_PS])
@pytest.mark.parametrize("constants", ["inline", "table"])
def test_the_same_command_gives_the_same_bytes(few_points, name, constants):
    first, second = (export.code(name, "python", "float", "Fn", constants) for _ in range(2))
    assert first == second
    assert ("coefficients = (" in first) == (constants == "table" and name == "g")


def test_the_header_says_when_half_is_not_good_enough(few_points):
    assert "NOT GOOD ENOUGH" in export.code("published/ps", "python", "half")
    assert "NOT GOOD ENOUGH" not in export.code("q", "python", "half")
    assert "precision: " not in export.code("published/ps", "python", "float")


@pytest.mark.parametrize(("precision", "most"), [("float", 2e-7), ("double", 4e-15)])
def test_the_closed_forms_header_says_what_its_steps_leave(few_points, precision, most):
    text = " ".join(export.code(EXACT_PS, "python", precision).replace("#", "").split())
    left = re.search(r"none but what the root's steps leave: rms (\S+), largest (\S+) ", text)
    assert 0 < float(left[1]) < float(left[2]) < most
