"""The paper's integrals against quadrature; and a test for each erratum, which fails if undone."""

import numpy as np
import pytest

from integrals.piecewise.published import (
    isotropic_mass,
    masking,
    partial_mass,
    partial_moment,
    visible_area,
)
from integrals.piecewise.published_sampling import algorithm_1, algorithm_2
from integrals.piecewise.smith import hidden_area, smith_g1, smith_lambda
from shading.piecewise.blend import Blend, azimuth_cdf
from shading.piecewise.moments import mass, normalised
from tests.integrals.piecewise_examples import (
    area_by_definition,
    blend_values,
    gauss,
    random_blend,
    random_profile,
    sampled,
    values_of,
)

DIRECTIONS = [(0.3, 0.2), (0.9, 0.7), (1.2, 2.0), (1.5, 1.4)]
ROUNDING = 1e-14


def test_equations_5_and_15():
    ndf = random_profile(3, 7)
    np.testing.assert_allclose(isotropic_mass(ndf), 1, rtol=ROUNDING)
    theta, w = gauss(np.asarray(ndf.knots))
    exact = np.sum(w * values_of(ndf, theta) * np.sin(theta) ** 2)
    np.testing.assert_allclose(partial_moment(ndf), exact, rtol=ROUNDING)


@pytest.mark.parametrize(("theta_o", "phi_o"), DIRECTIONS)
@pytest.mark.slow
def test_equations_16_23_26_and_27_are_the_parts_of_the_visible_area(theta_o, phi_o):
    ndf = random_blend(6)
    parts = visible_area(ndf, theta_o, phi_o)
    for name, value in parts._asdict().items():
        assert abs(value - area_by_definition(ndf, theta_o, phi_o, name)) < ROUNDING, name
    np.testing.assert_allclose(
        masking(ndf, theta_o, phi_o), smith_g1(ndf, theta_o, phi_o), rtol=1e-13
    )


def test_the_printed_sums_lose_digits_where_lambda_is_small():
    ndf = random_blend(6)
    lost = sum(visible_area(ndf, 1e-3, 0.2)) / np.cos(1e-3) - 1
    exact = float(smith_lambda(ndf, 1e-3, 0.2))
    assert abs(lost / exact - 1) > 1e-12


def test_erratum_eq_8_the_azimuth_is_not_integrated():
    """With the integral over φ, the CDF at π/2 is 1 for every φ_m, and so no density at φ_m."""
    ndf = random_blend(6)
    theta, w = gauss(np.asarray(ndf.x.knots))
    measure = w * np.cos(theta) * np.sin(theta)
    x0, y0 = float(ndf.x.values[0]), float(ndf.y.values[0])
    for phi in (0.1, 1.4):
        mended = 2 * np.pi * np.sum(measure * blend_values(ndf, theta, phi))
        said = (y0 * np.cos(phi) ** 2 + x0 * np.sin(phi) ** 2) / ((x0 + y0) / 2)
        np.testing.assert_allclose(mended, said, rtol=ROUNDING)
        assert abs(said - 1) > 0.005


def test_erratum_of_indices_the_first_segment_counts():
    """Eq. 15 from θ₁ on, with the knots θ₀ … θ_n of Eq. 4, leaves out the segment of the peak."""
    ndf = normalised(sampled("ggx", 0.1, 30))
    assert abs(partial_mass(ndf, 0.0, np.pi / 2) - 1) < 1e-13
    assert partial_mass(ndf, float(ndf.knots[1]), np.pi / 2) < 0.85


def test_erratum_of_algorithm_2_c_and_not_b():
    """C has the normalisation c: with it the angle has the wanted CDF."""
    ndf, phi, xi = random_blend(6), 0.4, 0.37
    drawn = algorithm_2(ndf, phi, xi, tolerance=1e-12)
    knots = np.asarray(ndf.x.knots)
    theta, w = gauss([0.0, *knots[(knots > 0) & (knots < drawn.angle)], drawn.angle])
    whole, w_whole = gauss(knots)

    def below(at, weights):
        return np.sum(weights * blend_values(ndf, at, phi) * np.cos(at) * np.sin(at))

    np.testing.assert_allclose(below(theta, w) / below(whole, w_whole), xi, atol=1e-10)


def test_erratum_eq_18_the_azimuth_is_relative():
    """o·m = 0 at cos(φ_m − φ_o) = −cot θo cot θ."""
    theta_o, phi_o, theta = 1.2, 0.9, 1.0
    azimuth = phi_o + np.arccos(-1 / (np.tan(theta_o) * np.tan(theta)))

    def projected(phi):
        return np.sin(theta_o) * np.sin(theta) * np.cos(phi - phi_o) + np.cos(theta_o) * np.cos(
            theta
        )

    assert abs(projected(azimuth)) < 1e-15
    assert abs(projected(azimuth - phi_o)) > 0.1


def test_erratum_eq_34_lambda_is_of_i11_and_i2():
    """Λ = (I₁₁ + I₂)/cos θo − ½ with I₁ = cos θo/2 + I₁₁; Eq. 34 prints I₁₁ as I₁, and an I₃."""
    ndf, theta_o, phi_o = random_blend(6), 1.1, 0.5
    parts, cosine = visible_area(ndf, theta_o, phi_o), np.cos(theta_o)
    exact = float(smith_lambda(ndf, theta_o, phi_o))
    mended = (parts.front - cosine / 2 + parts.back + parts.rim) / cosine - 0.5
    assert abs(mended - exact) < ROUNDING
    as_printed = (parts.front + parts.back + parts.rim) / cosine - 0.5
    assert abs(as_printed - exact) > 0.4


def test_erratum_of_notation_two_different_lambdas():
    """The Λ of Eq. 26 to 28 is a part of I₂², and not Smith's of Eq. 32."""
    ndf, theta_o = random_blend(6), 1.1
    edge = np.pi / 2 - theta_o
    taken = sum(
        -np.cos(theta_o) / 4 * factor * partial_mass(profile, edge, np.pi / 2)
        for factor, profile in zip(_factors(ndf), (ndf.x, ndf.y), strict=True)
    )
    of_equation_26 = visible_area(ndf, theta_o, 0.5).rim - taken
    assert abs(of_equation_26 - float(smith_lambda(ndf, theta_o, 0.5))) > 0.1


def _factors(ndf: Blend) -> tuple[float, float]:
    x0, y0 = float(ndf.x.values[0]), float(ndf.y.values[0])
    return 2 * y0 / (x0 + y0), 2 * x0 / (x0 + y0)


def test_errata_of_transcription_in_eq_23_and_25():
    """cos 2θo, not cos 2φo, in the moment below E; and the y-term of Eq. 25 has D_y."""
    ndf = random_profile(3, 7)
    edge = np.pi / 2 - 1.2
    knots, values = np.asarray(ndf.knots), np.asarray(ndf.values)
    k = np.searchsorted(knots, edge, side="right") - 1
    a = (values[k + 1] - values[k]) / (knots[k + 1] - knots[k])
    b, left = values[k] - a * knots[k], knots[k]

    def part(cosine):
        return (
            a * (np.cos(2 * left) + cosine)
            + 2 * (edge - left) * (a * (left + edge) + 2 * b)
            + 2 * (a * left + b) * np.sin(2 * left)
            - 2 * (a * edge + b) * np.sin(2 * 1.2)
        ) / 8

    exact = partial_moment(ndf, edge) - partial_moment(ndf, left)
    assert abs(part(np.cos(2 * 1.2)) - exact) < ROUNDING
    assert abs(part(np.cos(2 * 0.7)) - exact) > 1e-3
    blend = random_blend(6)
    twice_x = Blend(blend.x, blend.x)
    assert abs(visible_area(blend, 1.2, 0.7).rim - visible_area(twice_x, 1.2, 0.7).rim) > 1e-4


@pytest.mark.slow
def test_erratum_eq_28_creates_energy():
    """The trapezoid rule makes G1 exceed 1 for Beckmann 0.05 with ten segments."""
    ndf = normalised(sampled("beckmann", 0.05, 10))
    blend = Blend(ndf, ndf)
    angles = np.linspace(0.05, 1.565, 120)
    printed = np.array([masking(blend, each, 0.0, trapezoid=True) for each in angles])
    assert abs(printed.max() - 1.027) < 1e-3
    exact = np.array([masking(blend, each, 0.0) for each in angles[::6]])
    assert exact.max() <= 1 + 1e-12
    # Λ < 0 there, while H is an integral of what is nowhere negative.
    assert float(hidden_area(ndf, angles[printed.argmax()])) > 0


@pytest.mark.parametrize(
    ("width", "lost"), [pytest.param(0.05, 0.42, marks=pytest.mark.slow), (0.01, 0.97)]
)
def test_erratum_of_algorithm_2_it_does_not_end_in_float32(width, lost):
    ndf = normalised(sampled("ggx", width, 90))
    blend = Blend(ndf, ndf)
    samples = np.random.default_rng(1).random(120)
    endless = [
        algorithm_2(blend, 0.3, xi, kind=np.float32, most=60).steps is None for xi in samples
    ]
    # Within four standard deviations of 120 draws.
    assert abs(np.mean(endless) - lost) < 4 * np.sqrt(lost * (1 - lost) / 120)
    assert all(algorithm_2(blend, 0.3, xi).steps is not None for xi in samples[:30])


def test_algorithm_1_ends_and_inverts_the_cdf():
    ndf = random_blend(6)
    for xi in (0.0, 0.13, 0.3, 0.62, 0.97):
        for kind in (np.float64, np.float32):
            drawn = algorithm_1(ndf, xi, kind=kind)
            assert drawn.steps is not None
            assert abs(float(azimuth_cdf(ndf, drawn.angle)) - xi) < 2e-5


# n, width, c_iso, largest difference of G1 (exact integrals)
DISCRETISATION = {
    ("ggx", 0.05, 10): (3.478, 3.3e-2),
    ("ggx", 0.1, 30): (1.0415, 2.0e-3),
    ("ggx", 0.3, 30): (1.0042, 1.6e-4),
    ("beckmann", 0.05, 10): (3.275, 2.1e-1),
    ("beckmann", 0.1, 30): (1.0434, 1.6e-2),
}


@pytest.mark.parametrize("case", DISCRETISATION)
def test_the_mass_of_a_discretised_ndf(case):
    kind, width, segments = case
    np.testing.assert_allclose(
        mass(sampled(kind, width, segments)), DISCRETISATION[case][0], rtol=2e-4
    )
