"""Exported decoders: their code in every language, hostile texels, half precision, and proofs."""

import functools

import jax.numpy as jnp
import numpy as np
import pytest

from coefficients.catalogue import resolve
from coefficients.exported_code import trial_of
from programs import check, evaluate, toolchain, trace, write_source
from programs.bounding.compiled import compiler_missing
from programs.toolchains import verification
from quantities.maps import DECODERS
from quantities.maps.definiteness import prove_definite
from shading.maps.encode import encode
from shading.maps.encodings import ENCODINGS, LEAST_ALPHA, decode_entries

NAMES = [f"decode/{name}" for name in DECODERS]
WIDTHS = [f"decode/aniso-{name}" for name in ENCODINGS]


@functools.cache
def small_trial(name: str):
    return trial_of(resolve(name), "float", 10)


def evaluated(name: str, texels: np.ndarray, precision: str = "double") -> np.ndarray:
    """Evaluate an exported decoder at texels (n, 3), with every operation rounded."""
    dtype = {"double": np.float64, "float": np.float32, "half": np.float16}[precision]
    (function,) = resolve(name).functions(precision)
    return evaluate(trace(function), texels, dtype).astype(np.float64)


def some_widths(count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return αt ≥ αb from 0.03 to 1, and angles."""
    rng = np.random.default_rng(7)
    alphas = np.exp(rng.uniform(np.log(0.03), 0.0, (count, 2)))
    return alphas.max(1), alphas.min(1), rng.uniform(-np.pi / 2, np.pi / 2, count)


@pytest.mark.parametrize("name", ["decode/aniso-stereographic", "decode/aniso-quarter-root-matrix"])
def test_code_in_c_passes(name):
    if toolchain("c").missing("float"):
        pytest.skip("gcc is missing")
    trial = small_trial(name)
    result = check(trial, "c")
    assert result.status == "passed", result.reason
    assert result.form.not_finite == 0
    assert result.allowed.largest < 1e-4


def test_code_with_another_constant_fails(monkeypatch):
    def wrong(functions, *given, **options):
        source = write_source(functions, *given, **options)
        assert "2.0f * y - 1.0f" in source
        return source.replace("2.0f * y - 1.0f", "1.99f * y - 1.0f")

    monkeypatch.setattr(verification, "write_source", wrong)
    assert check(small_trial("decode/aniso-stereographic"), "c").status == "failed"


@pytest.mark.parametrize("precision", ["float", "half"])
@pytest.mark.parametrize("name", NAMES)
def test_any_texel_gives_finite_widths_and_definite_matrices(name, precision):
    numbers = [-3.0, -0.0, 0.0, 1e-4, 0.3, 0.5, 128 / 255, 0.999, 1.0, 7.0]
    texels = np.array([[x, y, z] for x in numbers for y in numbers for z in numbers])
    found = evaluated(name, texels, precision)
    assert np.isfinite(found).all()
    if name.endswith("matrix"):
        assert (found[:, [0, 2]] > 0).all()
        # In half precision, the largest correlation of the published encoding is rounded to one.
        rounded = name == "decode/aniso-published-matrix" and precision == "half"
        assert (found[:, 3] >= 0).all() if rounded else (found[:, 3] > 0).all()
        return
    # The root of the least width is rounded before it is squared.
    assert found[:, :2].min() >= LEAST_ALPHA * (1 - 2.0**-10) and found[:, :2].max() <= 1
    assert (found[:, 0] >= found[:, 1]).all() and (found[:, 2] >= 0).all()
    length = np.hypot(found[:, 2], found[:, 3])
    np.testing.assert_allclose(length, 1, atol=3e-3 if precision == "half" else 1e-6)


def test_infinite_channels_are_clamped_too():
    texels = np.array([[np.inf, -np.inf, np.inf], [-np.inf, np.inf, 0.5]])
    for name in NAMES:
        assert np.isfinite(evaluated(name, texels)).all()


# Relative errors of αb in half precision that 99 % of texels do not exceed, measured and rounded up
HALF = {"published": 0.03, "stereographic": 0.006, "quarter-root": 0.016, "logarithmic": 0.012}


@pytest.mark.parametrize("name", ENCODINGS)
def test_half_precision_keeps_the_smaller_width(name):
    alpha_t, alpha_b, theta = some_widths(20_000)
    texels = encode(name, alpha_t, alpha_b, theta)
    found = evaluated(f"decode/aniso-{name}", texels, "half")
    error = np.abs(found[:, 1] / alpha_b - 1)
    assert np.quantile(error, 0.99) <= HALF[name]
    # float32 keeps at least four digits of every width.
    single = evaluated(f"decode/aniso-{name}", texels, "float")
    assert np.abs(single[:, 1] / alpha_b - 1).max() < 1e-4


# The others take longer: 30 million boxes and more
@pytest.mark.parametrize(
    "name", ["published", *(pytest.param(each, marks=pytest.mark.slow) for each in ENCODINGS[1:3])]
)
def test_matrices_are_proven_to_be_positive_definite(name):
    if compiler_missing():
        pytest.skip("gcc is missing")
    assert prove_definite(name).holds


def _correlation_stored_beside_the_roots(x, y, z):
    """Return the matrix of an encoding that stores Sxy itself."""
    _, _, _, product = decode_entries("published", x, y, z)
    x, z = jnp.maximum(x, LEAST_ALPHA), jnp.maximum(z, LEAST_ALPHA)
    return x * x, 2 * y - 1, z * z, product


def test_a_decoder_that_is_not_definite_has_no_proof():
    if compiler_missing():
        pytest.skip("gcc is missing")
    proof = prove_definite(_correlation_stored_beside_the_roots)
    assert not proof.holds
    sxx, sxy, syy, _ = _correlation_stored_beside_the_roots(*proof.at)
    assert sxx * syy - sxy * sxy < 0
    # A product without its clamp may be zero.
    unclamped = prove_definite(lambda x, y, z: (1.0 + 0.0 * x, 0.0 * y, 1.0 + 0.0 * z, x * z))
    assert not unclamped.holds


def test_what_decoders_have_not_is_refused():
    with pytest.raises(ValueError, match="has no coefficients"):
        resolve(NAMES[0]).require_table()
    with pytest.raises(ValueError, match="no encoding is called 'x': allowed are published, ster"):
        prove_definite("x")
